//! Arguments of `attack run` and `attack baseline`.

use std::ops::Deref;
use std::path::PathBuf;

use crate::cli::choice::one_of;
use crate::cli::detectors::Folder;
use crate::cli::results::Programs;
use scaleproof_attack::run::view_set::TextureMapping;
use scaleproof_pose::scene::Classes;
use scaleproof_surface::pattern::MAX_CELLS;

/// What looks at what.
#[derive(Debug, Clone, clap::Args)]
pub struct Looking {
    /// Folders of frames, each view in three flat colours or more; several to see several models at once
    #[arg(value_name = "FRAMES", required = true)]
    pub frames: Vec<PathBuf>,
    /// The detectors to be misled; several at once as in yolox_nano,nanodet_m; a program as in 'exec:python3 mine.py'
    #[arg(
        long = "detector",
        value_name = "NAME",
        value_delimiter = ',',
        default_value = "yolox_nano"
    )]
    pub detector: Vec<String>,
    #[command(flatten)]
    pub folder: Folder,
    #[command(flatten)]
    pub programs: Programs,
    /// The label that counts as the model, or several, as in car,truck
    #[arg(long, value_name = "LABEL,…", default_value = "car")]
    pub class: Classes,
    /// Width of one repeat on the model, in mm [default: as the card of a pattern says that is there already; else 118]
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    pub tile_mm: Option<f64>,
    /// How the pattern lies on the model: as the printed panels do, or repeated over a plane that faces the camera
    /// (DTA)
    #[arg(long = "laying", default_value = "world", value_parser = one_of(TextureMapping::ALL.map(|mapping| (mapping, mapping.name()))))]
    pub mapping: TextureMapping,
    /// One JSON object instead of the text
    #[arg(long)]
    pub json: bool,
}

/// What looks at what, and the pattern to be made: its cells, its seed and its folder.
#[derive(Debug, Clone, clap::Args)]
pub struct OnFrames {
    #[command(flatten)]
    pub looking: Looking,
    /// Cells along each side [default: 24; of a pattern that is there already, its own]
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_CELLS)))]
    pub cells: Option<u32>,
    /// Seed of what is random; one seed gives one pattern
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Folder for the pattern, its card and its history; an interrupted run there is gone on with
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
}

impl Deref for OnFrames {
    type Target = Looking;

    fn deref(&self) -> &Looking {
        &self.looking
    }
}
