//! Arguments of `scene new --mesh`.

use std::path::PathBuf;

use scaleproof_core::geometry::SignedAxis;

/// The model's mesh and what the user knows of it.
#[derive(clap::Args)]
pub struct SceneMesh {
    /// The model's surface: .glb, .obj, .stl or .ply; in place of --model-size-mm
    #[arg(long, value_name = "FILE", conflicts_with = "model_size_mm")]
    pub mesh: Option<PathBuf>,
    /// Length of the printed model from front to rear in mm [default: by the mesh's unit, where only one makes a car of it]
    #[arg(long, value_name = "MM", allow_negative_numbers = true, requires = "mesh")]
    pub length_mm: Option<f64>,
    /// Where the front is in the mesh file: +x, -x, +y, -y, +z or -z [default: by its shape]
    #[arg(long, value_name = "AXIS", allow_hyphen_values = true, requires = "mesh")]
    pub mesh_front: Option<SignedAxis>,
    /// Where the top is in the mesh file [default: by its shape]
    #[arg(long, value_name = "AXIS", allow_hyphen_values = true, requires = "mesh")]
    pub mesh_up: Option<SignedAxis>,
    /// The paint: names of materials; or a file with the numbers of triangles, counted from 0; or all [default: by names and by area]
    #[arg(long, value_name = "NAME|FILE|all", num_args = 1.., requires = "mesh")]
    pub paint: Vec<String>,
}
