//! Arguments of `attack import`.

use std::path::PathBuf;

use clap::ValueEnum;

use crate::cli::args::model::ModelArgs;

/// Make frames of a folder that another engine exported (layouts of CARLA scripts; see the guide, `frames.md`)
#[derive(clap::Args)]
// Only one of the layouts needs a mesh.
#[command(mut_arg("mesh", |mesh| mesh.required_unless_present_any(["scene", "folder"]).help("The vehicle's surface: .glb, .obj, .stl or .ply (fca)")))]
pub struct ImportArgs {
    /// The folder with import.json, poses.csv, rgb/ and mask/, or with .npz files
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    /// What is in the folder
    #[arg(long, value_enum, default_value = "carla")]
    pub layout: Layout,
    #[command(flatten)]
    pub model: ModelArgs,
    /// How far below veh_trans the vehicle stands, in metres: scripts write down where it was put, before it dropped to the road
    #[arg(long, value_name = "M", allow_negative_numbers = true)]
    pub drop_m: Option<f64>,
    /// Horizontal field of view (fca) [default: 90]
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
    pub field_of_view_deg: Option<f64>,
    /// The reflectance of the paint as hex sRGB, if it is flat and known (fca)
    #[arg(long, value_name = "HEX")]
    pub flat: Option<String>,
    /// Folder for the frames
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// Print JSON instead of text
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub enum Layout {
    /// import.json, poses.csv, images and masks
    Carla,
    /// .npz files with img, veh_trans and cam_trans; the masks are drawn from the mesh
    Fca,
}
