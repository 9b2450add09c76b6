//! What `scene new` asks of a mesh, and what it gets.

use std::path::{Path, PathBuf};

use scaleproof_pose::scene::{Classes, Envelope, MeshFacts};

/// What a mesh is to become the model of.
pub(super) struct Wanted<'a> {
    pub class: &'a Classes,
    pub scale: f64,
    pub output: &'a Path,
}

/// What was found of a model's mesh.
pub(super) struct Taken {
    pub size_mm: [f64; 3],
    pub envelope: Envelope,
    pub mesh: MeshFacts,
    /// The image of its six views, to be written beside the scene.
    pub preview: (PathBuf, Vec<u8>),
    /// What was found, by what, and how to say otherwise: a line each.
    pub words: Vec<String>,
}
