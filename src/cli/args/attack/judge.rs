//! Arguments of `attack judge`.

use crate::cli::args::attack::on_frames::Looking;

/// What detectors make of patterns on every view of frames, predicted and not rendered: a minute's look before `attack evaluate`
#[derive(clap::Args)]
pub struct JudgeArgs {
    #[command(flatten)]
    pub on: Looking,
    /// Patterns and their names: PNG files of one size, square, or with --laying sides six squares below each other
    #[arg(long = "pattern", value_name = "NAME=PNG", num_args = 1.., required = true)]
    pub patterns: Vec<String>,
    /// What they are compared with: a flat colour as hex sRGB
    #[arg(long, value_name = "HEX", default_value = "808080")]
    pub normal: String,
}
