//! Arguments of `attack evaluate`.

use std::path::PathBuf;

use super::render::MESH;
use crate::cli::args::model::ModelArgs;
use crate::cli::detectors::Folder;
use crate::cli::results::Programs;
use crate::cli::score::Effort;
use scaleproof_frames::render::ROUGHNESS;
use scaleproof_pose::scene::Classes;

/// Judge patterns on the model: render them at the paper's viewpoints under other lights, and score the detectors on the photos
///
/// Each paint's photos are kept: run the same command again to go on after an interruption, and with more patterns to add them.
#[derive(clap::Args)]
#[command(mut_arg("mesh", |mesh| mesh.help(MESH)))]
pub struct EvaluateArgs {
    #[command(flatten)]
    pub model: ModelArgs,
    /// What the plain model wears: a flat colour as hex sRGB, as in 808080, or original for the mesh file's own materials
    #[arg(long, value_name = "HEX|original")]
    pub normal: String,
    /// Patterns and their names: PNG files with one pixel per cell, mapped onto the model as `print wrap` prints them
    #[arg(long = "pattern", value_name = "NAME=PNG", num_args = 1.., required_unless_present = "textures")]
    pub patterns: Vec<String>,
    /// Width of one repeat of the patterns on the model, in mm; without it, what each pattern's card says
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    pub tile_mm: Option<f64>,
    /// Textures and their names, as in car.obj or NAME=car.obj: images for the mesh's texture coordinates, .obj, .glb or .ply files with images of
    /// their own, or .npy files with the texels of each triangle
    #[arg(long = "texture", value_name = "[NAME=]FILE", num_args = 1..)]
    pub textures: Vec<String>,
    /// The detectors that the patterns were made against: table 1 has them, table 2 the others; all are in table 1 without it
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    pub target: Vec<String>,
    /// Detector to score; several may be named; all whose weights are here when none is
    #[arg(long = "detector", value_name = "NAME", value_delimiter = ',')]
    pub detectors: Vec<String>,
    #[command(flatten)]
    pub folder: Folder,
    #[command(flatten)]
    pub programs: Programs,
    /// Lights: Blender's own (city, courtyard, forest, interior, night, studio, sunrise, sunset) or .exr and .hdr files, turned as in forest@90;
    /// take others than the patterns were made under
    #[arg(long, value_name = "LIGHT", num_args = 1.., default_values = ["courtyard", "sunrise@60"])]
    pub light: Vec<String>,
    /// Azimuths in degrees, as in 0 45 90, or every so many degrees, as in every30
    #[arg(long, value_name = "DEG", num_args = 1.., default_value = "every30", allow_negative_numbers = true)]
    pub azimuth_deg: Vec<String>,
    #[arg(long, value_name = "DEG", num_args = 1.., default_values = ["0", "15", "30"], allow_negative_numbers = true)]
    pub pitch_deg: Vec<f64>,
    #[arg(long, value_name = "MM", num_args = 1.., default_values = ["900", "1200", "1500"], allow_negative_numbers = true)]
    pub distance_mm: Vec<f64>,
    /// Width and height of the photos in pixels, as in 320 or 320x240
    #[arg(long, value_name = "PX", default_value = "320x240")]
    pub size_px: String,
    /// Horizontal field of view
    #[arg(long, value_name = "DEG", default_value_t = 40.0, allow_negative_numbers = true)]
    pub field_of_view_deg: f64,
    /// Roughness of the paint's coat: 0 reflects like glass, 1 is matt
    #[arg(long, default_value_t = ROUGHNESS, allow_negative_numbers = true)]
    pub roughness: f64,
    /// Panorama paths a pixel, before the noise is cleaned away
    #[arg(long, default_value_t = 8)]
    pub samples: u32,
    #[arg(long, default_value_t = 1)]
    pub seed: u32,
    /// The label that counts as the model, or several, as in car,truck [default: as the scene says, else car]
    #[arg(long, value_name = "LABEL,…")]
    pub class: Option<Classes>,
    #[command(flatten)]
    pub effort: Effort,
    /// The tables as one JSON object instead of the text
    #[arg(long)]
    pub json: bool,
    /// Folder for the photos (a session, in `session`), evaluation.html, .csv and .tex, differences.csv, and the report of `score` in `score`
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
}
