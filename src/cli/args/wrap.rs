//! Arguments of `print wrap`.

use crate::cli::args::model::ModelArgs;
use crate::cli::args::pieces::PiecesArgs;
use crate::cli::args::texture::TextureArgs;
use crate::cli::print::PaperArgs;
use crate::cli::print::paint::PaintArgs;

/// Strip that neighbouring sheets of a panel share where nothing is said.
pub const OVERLAP_MM: f64 = 8.0;

/// Pixels per inch where nothing is said.
pub const DPI: f64 = 300.0;

#[derive(clap::Args)]
pub struct WrapArgs {
    #[command(flatten)]
    pub model: ModelArgs,
    #[command(flatten)]
    pub texture: TextureArgs,
    #[command(flatten)]
    pub pieces: PiecesArgs,
    #[command(flatten)]
    pub sheets: SheetArgs,
    #[command(flatten)]
    pub paint: PaintArgs,
    /// One JSON object instead of text
    #[arg(long)]
    pub json: bool,
}

/// What it is printed on.
#[derive(clap::Args)]
pub struct SheetArgs {
    #[command(flatten)]
    pub paper: PaperArgs,
    /// Strip that neighbouring sheets of a panel share for gluing, in mm [default: 8]
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    pub overlap_mm: Option<f64>,
}
