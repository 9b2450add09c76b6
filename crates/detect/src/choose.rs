//! Detectors as users name them: by a name, a manifest, or an ONNX file with its manifest beside it. Those that a user registered have their
//! manifests in the user's data folder, so that their names are known everywhere.

use std::path::{Path, PathBuf};

use super::manifest::is_network;
use super::program::interpreter;
use super::{Manifest, ManifestError, ProgramSpec, WeightFolders, WeightsError};
use scaleproof_core::files::{self, FileError};
use scaleproof_core::message::{Message, bail, message};

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

/// Returns how another run, started in another folder, chooses the same detector again: a manifest's whole path, else the name.
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
        bail!(
            "{name} is a program, and here a network is needed: programs can be checked, scored, compared and attacked, and nothing else"
        );
    }
    if name.ends_with(".toml") {
        return Manifest::open(Path::new(name));
    }
    if is_network(name) {
        return beside(Path::new(name));
    }
    if let Some(interpreter) = interpreter(name) {
        // What stands before a colon was to be `exec:`.
        let script = name.rsplit(':').next().unwrap_or(name).trim();
        bail!("{name} is a program and no detector's name: write 'exec:{interpreter} {script}'");
    }
    if let Some(refusal) = other_format(name) {
        return Err(refusal.into());
    }
    if let Some(manifest) = registered(name)? {
        return Ok(manifest);
    }
    Manifest::named_among(name, &registered_names())
}

/// The manifest beside an ONNX file, which must be about this file.
fn beside(network: &Path) -> Result<Manifest, ManifestError> {
    let manifest = network.with_extension("toml");
    let (shown, beside) = (network.display(), manifest.display());
    if !network.is_file() {
        bail!("there is no file {shown}");
    }
    if !manifest.is_file() {
        bail!(
            "{shown} has no manifest {beside} beside it, which says how the network is fed and read";
            hint: "run `scaleproof detectors add {shown}` first"
        );
    }
    let found = Manifest::open(&manifest)?;
    let described = manifest.with_file_name(&found.weights.file);
    if described.canonicalize().ok() == network.canonicalize().ok() {
        return Ok(found);
    }
    let described = found.weights.file;
    bail!("{beside} describes {described} and not {shown}: name the manifest of this network")
}

/// Refuses a file that holds a network in another form than ONNX, by its ending; `None` for any other name.
fn other_format(file: &str) -> Option<Message> {
    let path = Path::new(file);
    let stem = path.with_extension("");
    let stem = stem.display();
    let (what, hint) = match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
        "pt" | "pth" | "ckpt" | "torchscript" | "safetensors" => (
            "a network of PyTorch",
            format!(
                "export it (Ultralytics: `yolo export model={file} format=onnx`) and add it by `scaleproof detectors add {stem}.onnx`, or run it in Python: \
                 ‹detector› 'exec:python3 python/examples/ultralytics_yolo.py {file}' (docs/guide/detector-programs.md)"
            ),
        ),
        "weights" | "cfg" => (
            "part of a network of Darknet",
            format!("make a detector of both files by `scaleproof detectors add {stem}.cfg {stem}.weights`"),
        ),
        "tflite" | "pb" | "h5" | "keras" | "engine" | "trt" | "mlmodel" | "xml" | "bin" | "param" | "caffemodel"
        | "pdmodel" => (
            "a network of another framework",
            format!(
                "export it and add it by `scaleproof detectors add {stem}.onnx`, or run it in a program of yours: ‹detector› 'exec:python3 mine.py' \
                 (docs/guide/detector-programs.md)"
            ),
        ),
        _ => return None,
    };
    Some(message!("{file} holds {what}, and networks are read from ONNX files").hint(hint))
}

/// Why a detector was not registered or taken off the list.
#[derive(Debug, thiserror::Error)]
pub enum RegisterError {
    #[error(transparent)]
    Message(#[from] Message),
    #[error(transparent)]
    Weights(#[from] WeightsError),
    #[error(transparent)]
    Manifest(#[from] ManifestError),
    #[error(transparent)]
    File(#[from] FileError),
}

/// Returns the folder of the registered detectors' manifests.
fn folder() -> Option<PathBuf> {
    Some(dirs::data_dir()?.join("scaleproof").join("detectors"))
}

/// Returns the path of a registered detector's manifest.
fn path(name: &str) -> Option<PathBuf> {
    Some(folder()?.join(format!("{name}.toml")))
}

fn no_folder() -> Message {
    message!("no folder for detectors: set HOME or XDG_DATA_HOME")
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
    let name = &manifest.name;
    if Manifest::all()?.iter().any(|m| m.name == *name) {
        bail!("{name} ships with scaleproof: give your detector another name in its manifest");
    }
    let mut kept = manifest.clone();
    match folders.checked(manifest) {
        Ok(weights) => {
            let weights = weights.canonicalize().unwrap_or(weights);
            kept.weights.file = weights.to_string_lossy().into_owned();
            kept.weights.url.clear();
        }
        Err(WeightsError::Missing(_)) if !manifest.weights.url.is_empty() => {}
        Err(e) => return Err(e.into()),
    }
    let path = path(name).ok_or_else(no_folder)?;
    let text = kept.to_toml()?;
    if !path.exists() {
        files::replace_atomically(files::folder_of(&path), &path, text.as_bytes())?;
    } else if files::read_text(&path).ok() != Some(text) {
        bail!(
            "a detector called {name} is registered already, and it is another one: take it off with `scaleproof detectors remove {name}`, or give yours another name in its manifest"
        );
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
        bail!("no registered detector is called {name}{registered}");
    }
    let path = path(name).ok_or_else(no_folder)?;
    files::chosen::remove(files::folder_of(&path), &path)?;
    Ok(path)
}
