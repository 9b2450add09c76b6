//! Detectors as users name them: by a name, a manifest, or an ONNX file with its manifest beside it.

use std::path::Path;

use super::manifest::is_network;
use super::{Manifest, ManifestError, ProgramSpec, registered, registered_names};
use scaleproof_core::files::{self, FileError};

/// The named detectors, each once, or all that ship with the program. Registered detectors take part when they are named.
pub fn choose(names: &[String]) -> Result<Vec<Manifest>, ManifestError> {
    if names.is_empty() {
        return Manifest::all();
    }
    let mut manifests: Vec<Manifest> = Vec::new();
    for name in names {
        let manifest = one(name)?;
        if !manifests.contains(&manifest) {
            manifests.push(manifest);
        }
    }
    Ok(manifests)
}

/// How another run, started in another folder, chooses the same detector again: a manifest's whole path, else the name.
pub fn chosen_as(manifest: &Manifest, names: &[String]) -> Result<String, FileError> {
    let files = names.iter().filter(|name| is_file(name));
    let mut files = files.map(|name| Path::new(name).with_extension("toml"));
    match files.find(|path| Manifest::open(path).is_ok_and(|m| m == *manifest)) {
        Some(path) => Ok(files::whole_path(&path)?.display().to_string()),
        None => Ok(manifest.name.clone()),
    }
}

/// Whether a name is that of a file: a manifest or a network.
fn is_file(name: &str) -> bool {
    name.ends_with(".toml") || is_network(name)
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
