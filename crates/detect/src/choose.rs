//! Detectors as users name them: by a name, a manifest, or an ONNX file with its manifest beside it. Those that a user registered have their
//! manifests in the user's data folder, so that their names are known everywhere.

use std::path::{Path, PathBuf};

use super::manifest::is_network;
use super::program::interpreter;
use super::{Manifest, ManifestError, NetworkFormat, ProgramSpec, WeightFolders, WeightsError};
use scaleproof_core::files::{self, FileError};

/// The named detectors, each once, or all that ship with the program. Registered detectors take part when they are named.
pub fn choose(names: &[String]) -> Result<Vec<Manifest>, ManifestError> {
    if names.is_empty() {
        return Manifest::all();
    }
    let mut manifests: Vec<Manifest> = Vec::new();
    for name in names {
        // As typed behind a comma: `yolox_nano, fastestdet`.
        let manifest = one(name.trim())?;
        if !manifests.contains(&manifest) {
            manifests.push(manifest);
        }
    }
    Ok(manifests)
}

/// How another run, started in another folder, chooses the same detector again: a manifest's whole path, else the name.
pub fn chosen_as(manifest: &Manifest, names: &[String]) -> Result<String, FileError> {
    let files = names.iter().filter(|name| name.ends_with(".toml") || is_network(name));
    let mut files = files.map(|name| Path::new(name).with_extension("toml"));
    match files.find(|path| Manifest::open(path).is_ok_and(|m| m == *manifest)) {
        Some(path) => Ok(files::whole_path(&path)?.display().to_string()),
        None => Ok(manifest.name.clone()),
    }
}

fn one(name: &str) -> Result<Manifest, ManifestError> {
    if let Ok(Some(_)) = ProgramSpec::named(name) {
        let name = name.to_owned();
        return Err(ManifestError::Program { name });
    }
    if name.ends_with(".toml") {
        return Manifest::open(Path::new(name));
    }
    if is_network(name) {
        return beside(Path::new(name));
    }
    if let Some(interpreter) = interpreter(name) {
        // What stands before a colon was to be `exec:`.
        let script = name.rsplit(':').next().unwrap_or(name).trim().to_owned();
        let name = name.to_owned();
        return Err(ManifestError::Script {
            name,
            script,
            interpreter,
        });
    }
    if let Some(format) = NetworkFormat::of(name) {
        let name = name.to_owned();
        return Err(ManifestError::OtherFormat { name, format });
    }
    if let Some(manifest) = registered(name)? {
        return Ok(manifest);
    }
    Manifest::named(name).map_err(|e| match e {
        ManifestError::Unknown { name, known } => {
            let known = [known, registered_names()].concat();
            ManifestError::Unknown { name, known }
        }
        e => e,
    })
}

/// The manifest beside an ONNX file, which must be about this file.
fn beside(network: &Path) -> Result<Manifest, ManifestError> {
    let (network, manifest) = (network.to_owned(), network.with_extension("toml"));
    if !network.is_file() {
        return Err(ManifestError::NoNetwork { network });
    }
    if !manifest.is_file() {
        return Err(ManifestError::NoManifest { network, manifest });
    }
    let found = Manifest::open(&manifest)?;
    let described = manifest.with_file_name(&found.weights.file);
    if described.canonicalize().ok() == network.canonicalize().ok() {
        return Ok(found);
    }
    let described = found.weights.file;
    Err(ManifestError::OtherNetwork {
        network,
        manifest,
        described,
    })
}

/// Why a detector was not registered or taken off the list.
#[derive(Debug, thiserror::Error)]
pub enum RegisterError {
    #[error("no folder for detectors: set HOME or XDG_DATA_HOME")]
    NoFolder,
    #[error("{name} ships with scaleproof: give your detector another name in its manifest")]
    BuiltIn { name: String },
    #[error(
        "a detector called {name} is registered already, and it is another one: take it off with `scaleproof detectors remove {name}`, or give \
         yours another name in its manifest"
    )]
    Taken { name: String },
    #[error("no registered detector is called {name}{registered}")]
    NotThere { name: String, registered: String },
    #[error(transparent)]
    Weights(#[from] WeightsError),
    #[error(transparent)]
    Manifest(#[from] ManifestError),
    #[error(transparent)]
    File(#[from] FileError),
}

/// Where the manifests of registered detectors lie.
fn folder() -> Option<PathBuf> {
    Some(dirs::data_dir()?.join("scaleproof").join("detectors"))
}

/// Where the manifest of a registered detector lies.
fn path(name: &str) -> Option<PathBuf> {
    Some(folder()?.join(format!("{name}.toml")))
}

/// The names of the registered detectors, in alphabetical order.
pub fn registered_names() -> Vec<String> {
    folder().map_or_else(Vec::new, |folder| names_in(&folder, ".toml"))
}

/// The detectors that have a file with such an ending in a folder, in alphabetical order; none when there is no such folder.
pub(super) fn names_in(folder: &Path, ending: &str) -> Vec<String> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let names = entries.filter_map(|entry| Some(entry.file_name().to_str()?.strip_suffix(ending)?.to_owned()));
    let mut names: Vec<String> = names.filter(|name| Manifest::is_name(name)).collect();
    names.sort();
    names
}

/// A registered detector; `None` when no detector is registered by this name.
pub fn registered(name: &str) -> Result<Option<Manifest>, ManifestError> {
    let path = path(name).filter(|path| Manifest::is_name(name) && path.is_file());
    path.map(|path| Manifest::open(&path)).transpose()
}

/// Keeps a manifest in the user's data folder and returns where. The weights stay where they are and are named by their whole path; those that
/// are only to be fetched keep their address.
pub fn register(manifest: &Manifest, folders: &WeightFolders) -> Result<PathBuf, RegisterError> {
    let name = manifest.name.clone();
    if Manifest::all()?.iter().any(|m| m.name == name) {
        return Err(RegisterError::BuiltIn { name });
    }
    let mut kept = manifest.clone();
    match folders.checked(manifest) {
        Ok(weights) => {
            let weights = weights.canonicalize().unwrap_or(weights);
            kept.weights.file = weights.to_string_lossy().into_owned();
            kept.weights.url.clear();
        }
        Err(WeightsError::Missing { .. }) if !manifest.weights.url.is_empty() => {}
        Err(e) => return Err(e.into()),
    }
    let path = path(&name).ok_or(RegisterError::NoFolder)?;
    let text = kept.to_toml()?;
    if !path.exists() {
        files::replace_atomically(files::folder_of(&path), &path, text.as_bytes())?;
    } else if files::read_text(&path).ok() != Some(text) {
        return Err(RegisterError::Taken { name });
    }
    Ok(path)
}

/// Takes a detector off the list; its weights and the manifest it was registered from stay.
pub fn unregister(name: &str) -> Result<PathBuf, RegisterError> {
    let names = registered_names();
    if !names.iter().any(|known| known == name) {
        let registered = match names.join(", ") {
            none if none.is_empty() => ": none is registered".into(),
            names => format!(": registered are {names}"),
        };
        let name = name.to_owned();
        return Err(RegisterError::NotThere { name, registered });
    }
    let path = path(name).ok_or(RegisterError::NoFolder)?;
    files::chosen::remove(files::folder_of(&path), &path)?;
    Ok(path)
}
