//! Shape of the model for its ground truth box.

use std::path::{Path, PathBuf};

/// Shape whose projection is a photo's ground truth box. A mesh is a `.glb`, `.obj`, `.stl` or `.ply`; its path is relative to the scene file's
/// folder.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Envelope {
    /// The box of the model's size.
    #[default]
    Box,
    /// The convex hull of a mesh.
    Hull(PathBuf),
    Mesh(PathBuf),
}

impl Envelope {
    /// Returns the word in `scene.toml`.
    pub fn name(&self) -> &'static str {
        match self {
            Envelope::Box => "box",
            Envelope::Hull(_) => "hull",
            Envelope::Mesh(_) => "mesh",
        }
    }

    /// Returns the file of the mesh; `None` for a box.
    pub fn mesh(&self) -> Option<&Path> {
        match self {
            Envelope::Box => None,
            Envelope::Hull(path) | Envelope::Mesh(path) => Some(path),
        }
    }

    /// Replaces the path of the mesh by `place` of it; a box is unchanged.
    pub(super) fn with_mesh(self, place: impl FnOnce(PathBuf) -> PathBuf) -> Envelope {
        match self {
            Envelope::Box => Envelope::Box,
            Envelope::Hull(path) => Envelope::Hull(place(path)),
            Envelope::Mesh(path) => Envelope::Mesh(place(path)),
        }
    }
}
