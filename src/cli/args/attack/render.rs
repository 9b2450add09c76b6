//! Arguments of `attack render`.

use std::path::PathBuf;

use crate::cli::args::model::ModelArgs;
use scaleproof_frames::render::ROUGHNESS;

/// Help of `--mesh` for commands that render the mesh.
pub const MESH: &str = "The model's surface: .glb, .obj, .stl or .ply; without it, the scene's mesh";

/// Render frames with Blender Cycles: every light × azimuth × pitch × distance × paint
#[derive(clap::Args)]
#[command(mut_arg("mesh", |mesh| mesh.help(MESH)))]
pub struct RenderArgs {
    #[command(flatten)]
    pub model: ModelArgs,
    /// Lights: Blender's own (city, courtyard, forest, interior, night, studio, sunrise, sunset) or .exr and .hdr files, turned as in forest@90
    #[arg(long, value_name = "LIGHT", num_args = 1.., default_value = "forest")]
    pub light: Vec<String>,
    /// Azimuths in degrees, as in 0 45 90, or every so many degrees, as in every45
    #[arg(long, value_name = "DEG", num_args = 1.., default_value = "every45", allow_negative_numbers = true)]
    pub azimuth_deg: Vec<String>,
    #[arg(long, value_name = "DEG", num_args = 1.., default_value = "15", allow_negative_numbers = true)]
    pub pitch_deg: Vec<f64>,
    #[arg(long, value_name = "MM", num_args = 1.., default_value = "1000", allow_negative_numbers = true)]
    pub distance_mm: Vec<f64>,
    /// Flat colours as hex sRGB, as in 808080
    #[arg(long, value_name = "HEX", num_args = 1..)]
    pub flat: Vec<String>,
    /// Patterns: PNG files with one pixel per cell, mapped onto the model as `print wrap` prints them
    #[arg(long, value_name = "PNG", num_args = 1.., requires = "tile_mm")]
    pub pattern: Vec<PathBuf>,
    /// Width of one repeat of the patterns on the model, in mm
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    pub tile_mm: Option<f64>,
    /// Textures, as in car.obj or NAME=car.obj: images for the mesh's texture coordinates, .obj, .glb or .ply files with images of their own, or
    /// .npy files with the texels of each triangle
    #[arg(long, value_name = "[NAME=]FILE", num_args = 1..)]
    pub texture: Vec<String>,
    /// Width and height of the frames in pixels, as in 256 or 256x192
    #[arg(long, value_name = "PX", default_value = "256")]
    pub size_px: String,
    /// Horizontal field of view
    #[arg(long, value_name = "DEG", default_value_t = 50.0, allow_negative_numbers = true)]
    pub field_of_view_deg: f64,
    /// Roughness of the paint's coat: 0 reflects like glass, 1 is matt
    #[arg(long, default_value_t = ROUGHNESS, allow_negative_numbers = true)]
    pub roughness: f64,
    /// Panorama paths a pixel
    #[arg(long, default_value_t = 64)]
    pub samples: u32,
    /// Clean the noise away (Open Image Denoise): 8 paths a pixel are then enough for an attack, but light no longer adds up exactly
    #[arg(long)]
    pub denoise: bool,
    #[arg(long, default_value_t = 1)]
    pub seed: u32,
    /// Points along each side of a pixel at which the paint's position is kept
    #[arg(long, default_value_t = 2)]
    pub position_factor: u32,
    /// Threads of Blender; 0 is all
    #[arg(long, default_value_t = 0)]
    pub threads: u32,
    /// Folder for the frames; what is there already is kept
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// Print JSON instead of text
    #[arg(long)]
    pub json: bool,
}
