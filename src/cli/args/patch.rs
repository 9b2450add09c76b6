//! Arguments of `print patch`.

use std::path::PathBuf;

use crate::cli::args::model::ModelArgs;
use crate::cli::args::wrap::SheetArgs;
use crate::cli::print::value_names;
use scaleproof_surface::pattern::world_aligned::Side;

#[derive(clap::Args)]
pub struct PatchArgs {
    #[command(flatten)]
    pub model: ModelArgs,
    #[command(flatten)]
    pub places: PlaceArgs,
    #[command(flatten)]
    pub sheets: SheetArgs,
    /// One JSON object instead of text
    #[arg(long)]
    pub json: bool,
}

/// Patches in their places.
#[derive(clap::Args)]
pub struct PlaceArgs {
    /// A finished texture, PNG or JPEG; for several patches repeat this and the next three options
    #[arg(long, value_name = "FILE")]
    pub patch: Vec<PathBuf>,
    /// The panel it goes on
    #[arg(long, value_parser = side(), requires = "patch")]
    pub panel: Vec<Side>,
    /// The patch's middle as the panel is seen from outside: to the right of the model's middle and above the ground (on the
    /// roof: before the middle), in mm, as in -40,65
    #[arg(long, value_name = "X,Y", requires = "patch", allow_hyphen_values = true)]
    pub at_mm: Vec<String>,
    /// Its width, or width and height, in mm, as in 60 or 60x40
    #[arg(long, value_name = "W[xH]", requires = "patch", allow_hyphen_values = true)]
    pub size_mm: Vec<String>,
}

value_names!(side -> Side: Left "left", Right "right", Roof "roof", Front "front", Rear "rear");
