//! Request of `scene new` about a mesh, and the model that is made of the mesh.

use std::path::{Path, PathBuf};

use scaleproof_pose::scene::{Classes, Envelope, MeshFacts};

/// Class, scale and scene file of the model that a mesh becomes.
pub(super) struct Wanted<'a> {
    pub class: &'a Classes,
    pub scale: f64,
    pub output: &'a Path,
}

/// Facts of a model that were found from its mesh.
pub(super) struct Taken {
    pub size_mm: [f64; 3],
    pub envelope: Envelope,
    pub mesh: MeshFacts,
    /// The image of its six views, to be written beside the scene.
    pub preview: (PathBuf, Vec<u8>),
    /// Lines for the user: the facts, why they are assumed, and the options that change them.
    pub words: Vec<String>,
}
