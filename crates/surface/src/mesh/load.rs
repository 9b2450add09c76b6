//! Files of meshes, by their format.

use std::path::Path;

use super::error::MeshError;
use super::placement::MeshPlacement;
use super::soup::{MAX_BYTES, MAX_TRIANGLES, Soup, Trouble};
use super::triangles::Mesh;
use super::{glb, obj, ply, stl};
use scaleproof_core::files;

impl Mesh {
    /// Reads a file and puts it into the model frame. Corners at the same place become one.
    pub fn load(path: &Path, placement: &MeshPlacement) -> Result<Self, MeshError> {
        let extension = path.extension().map(|e| e.to_ascii_lowercase());
        let read = match extension.as_ref().and_then(|e| e.to_str()) {
            Some("glb") => glb::read,
            Some("obj") => obj::read,
            Some("stl") => stl::read,
            Some("ply") => ply::read,
            _ => return Err(MeshError::UnknownFormat { path: path.to_owned() }),
        };
        let bytes = files::read(path)?;
        let too_large = |what| MeshError::TooLarge {
            path: path.to_owned(),
            what,
        };
        if bytes.len() > MAX_BYTES {
            return Err(too_large(format!("{} MB", bytes.len() / 1_000_000)));
        }
        let mut soup = Soup::new(path.parent().unwrap_or(Path::new("")).to_owned());
        let read = read(&bytes, &mut soup);
        let mut mesh = soup.mesh;
        if mesh.coordinates.iter().all(Option::is_none) {
            mesh.coordinates.clear();
        }
        match read {
            Ok(()) if mesh.triangles.is_empty() => Err(MeshError::NoFaces { path: path.to_owned() }),
            Ok(()) => placement.apply(mesh, path),
            Err(Trouble::TooManyTriangles) => Err(too_large(format!("more than {MAX_TRIANGLES} triangles"))),
            Err(Trouble::Damaged(reason)) => Err(MeshError::Damaged {
                path: path.to_owned(),
                reason: reason.replace('\n', " "),
            }),
        }
    }
}
