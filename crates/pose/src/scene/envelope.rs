//! The shape of the model for ground truth boxes.

use std::path::{Path, PathBuf};

/// The shape whose projection is a photo's truth box. A mesh is a `.glb`, `.obj`, `.stl` or `.ply`; its path counts from the scene
/// file's folder.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Envelope {
    /// The box of the model's size.
    #[default]
    Box,
    /// The convex hull of a mesh.
    Hull(PathBuf),
    /// A mesh.
    Mesh(PathBuf),
}

impl Envelope {
    /// The word in `scene.toml`.
    pub fn name(&self) -> &'static str {
        match self {
            Envelope::Box => "box",
            Envelope::Hull(_) => "hull",
            Envelope::Mesh(_) => "mesh",
        }
    }

    /// The file it is made of.
    pub fn mesh(&self) -> Option<&Path> {
        match self {
            Envelope::Box => None,
            Envelope::Hull(path) | Envelope::Mesh(path) => Some(path),
        }
    }

    /// The envelope with its mesh at another path, made from its path so far; a box stays as it is.
    pub fn with_mesh(self, place: impl FnOnce(PathBuf) -> PathBuf) -> Envelope {
        match self {
            Envelope::Box => Envelope::Box,
            Envelope::Hull(path) => Envelope::Hull(place(path)),
            Envelope::Mesh(path) => Envelope::Mesh(place(path)),
        }
    }
}
