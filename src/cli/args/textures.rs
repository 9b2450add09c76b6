//! Arguments of `texture`.

use std::path::PathBuf;

use clap::Subcommand;

use crate::cli::args::model::ModelArgs;
use crate::cli::args::patch::PlaceArgs;
use crate::cli::args::texture::TextureArgs;

/// Colour of materials without an image in a preview.
pub const GREY: [u8; 3] = [96; 3];

/// Below patches alone.
pub const PAPER: [u8; 3] = [255; 3];

#[derive(Subcommand)]
pub enum Command {
    /// Write a pattern or texture as one image on texture coordinates, and the mesh that uses it: for CARLA, Unreal, Unity or Blender
    ///
    /// The mesh's own coordinates are kept where they can hold an image; where they are missing, overlap or leave the image, the paint is
    /// unwrapped anew. Beside the image come a .obj in the frame and unit of the mesh's file, its .mtl, and a .glb.
    Bake(Box<BakeArgs>),
    /// Draw the model in a pattern or texture from all around, without Blender
    Show(Box<ShowArgs>),
}

/// A painted model.
#[derive(clap::Args)]
pub struct PaintedArgs {
    #[command(flatten)]
    pub model: ModelArgs,
    #[command(flatten)]
    pub texture: TextureArgs,
    #[command(flatten)]
    pub places: PlaceArgs,
}

#[derive(clap::Args)]
pub struct BakeArgs {
    #[command(flatten)]
    pub painted: PaintedArgs,
    /// Width and height of the image in pixels, as in 2048 or 2448x2432
    #[arg(long, value_name = "PX", default_value = "2048")]
    pub size: String,
    /// Unwrap the paint anew even where the mesh's own coordinates can be kept
    #[arg(long)]
    pub unwrap: bool,
    /// The image; the .obj, .mtl and .glb beside it are called the same
    #[arg(short, long, value_name = "PNG")]
    pub output: PathBuf,
    /// One JSON object instead of text
    #[arg(long)]
    pub json: bool,
}

#[derive(clap::Args)]
pub struct ShowArgs {
    #[command(flatten)]
    pub painted: PaintedArgs,
    /// Azimuths in degrees, as in 0 45 90, or every so many degrees, as in every45
    #[arg(long, value_name = "DEG", num_args = 1.., default_value = "every45", allow_negative_numbers = true)]
    pub azimuth_deg: Vec<String>,
    #[arg(long, value_name = "DEG", default_value_t = 20.0, allow_negative_numbers = true)]
    pub pitch_deg: f64,
    /// Width and height of each view in pixels, as in 480x360
    #[arg(long, value_name = "PX", default_value = "480x360")]
    pub size_px: String,
    /// One .png with all views, or a folder for an image of each
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// One JSON object instead of text
    #[arg(long)]
    pub json: bool,
}
