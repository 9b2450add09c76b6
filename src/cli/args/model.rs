//! Arguments about the model that a command works on.

use std::path::PathBuf;

/// The model.
#[derive(clap::Args, Clone)]
pub struct ModelArgs {
    /// The model's surface: .glb, .obj, .stl or .ply; without it, the scene's mesh, or the box of its model
    #[arg(long, value_name = "FILE")]
    pub mesh: Option<PathBuf>,
    /// The materials that are the paint; without it, the scene's paint, or all
    #[arg(long, value_name = "NAME", num_args = 1.., conflicts_with = "faces")]
    pub material: Vec<String>,
    /// The triangles that are the paint: a file with their numbers, counted from 0 in the mesh file's order, white space between them
    #[arg(long, value_name = "FILE")]
    pub faces: Option<PathBuf>,
    /// The scene whose model this is (`scene new --mesh`): its mesh, axes, paint, size and scale are taken, and an option that is given wins over
    /// what it says. Another mesh than the scene's is held against its size
    #[arg(long, value_name = "TOML")]
    pub scene: Option<PathBuf>,
    /// Scale the mesh to this length from front to rear, in mm
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    pub length_mm: Option<f64>,
    /// Where the front is in the mesh file: +x, -x, +y, -y, +z or -z [default: as the scene says; else +z in a .glb, +x in others]
    #[arg(long, value_name = "AXIS", allow_hyphen_values = true)]
    pub mesh_front: Option<String>,
    /// Where the top is in the mesh file [default: as the scene says; else +y in a .glb, +z in others]
    #[arg(long, value_name = "AXIS", allow_hyphen_values = true)]
    pub mesh_up: Option<String>,
    /// The model is 1:SCALE (named in the captions) [default: the scene's, else 10]
    #[arg(long, allow_negative_numbers = true)]
    pub scale: Option<f64>,
}
