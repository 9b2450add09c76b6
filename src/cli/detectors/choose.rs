//! What `--detector` takes: a name, a manifest, or an ONNX file with its manifest beside it.

use std::path::Path;

use super::CommandResultOf;
use crate::detect::{Manifest, ManifestError, registered, registered_names};

/// The named detectors, each once, or all that ship with the program. Registered detectors take part when they are named.
pub fn chosen(names: &[String]) -> CommandResultOf<Vec<Manifest>> {
    if names.is_empty() {
        return Ok(Manifest::all()?);
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
pub fn chosen_as(manifest: &Manifest, names: &[String]) -> std::io::Result<String> {
    let files = names.iter().filter(|name| is_file(name));
    let mut files = files.map(|name| Path::new(name).with_extension("toml"));
    match files.find(|path| Manifest::open(path).is_ok_and(|m| m == *manifest)) {
        Some(path) => Ok(path.canonicalize()?.display().to_string()),
        None => Ok(manifest.name.clone()),
    }
}

/// Whether a name is that of a file: a manifest or a network.
fn is_file(name: &str) -> bool {
    name.ends_with(".toml") || is_network(name)
}

fn is_network(name: &str) -> bool {
    let lower = name.to_ascii_lowercase();
    lower.ends_with(".onnx") || lower.ends_with(".ort")
}

fn one(name: &str) -> CommandResultOf<Manifest> {
    if name.ends_with(".toml") {
        return Ok(Manifest::open(Path::new(name))?);
    }
    if is_network(name) {
        return of_network(Path::new(name));
    }
    if let Some(manifest) = registered(name)? {
        return Ok(manifest);
    }
    Manifest::named(name).map_err(|e| match e {
        ManifestError::Unknown { name, known } => {
            let known = [known, registered_names()].concat();
            ManifestError::Unknown { name, known }.into()
        }
        e => e.into(),
    })
}

/// The manifest beside an ONNX file, which must be about this file.
fn of_network(network: &Path) -> CommandResultOf<Manifest> {
    let (path, shown) = (network.with_extension("toml"), network.display());
    if !network.is_file() {
        return Err(format!("there is no file {shown}").into());
    }
    if !path.is_file() {
        return Err(format!(
            "{shown} has no manifest {} beside it, which says how the network is fed and read: run `scaleproof detectors add {shown}` first",
            path.display()
        )
        .into());
    }
    let manifest = Manifest::open(&path)?;
    let described = path.parent().unwrap_or(Path::new("")).join(&manifest.weights.file);
    let is_same = described.canonicalize().ok() == network.canonicalize().ok();
    match is_same {
        true => Ok(manifest),
        false => Err(format!(
            "{} describes {} and not {shown}: name the manifest of this network",
            path.display(),
            manifest.weights.file
        )
        .into()),
    }
}
