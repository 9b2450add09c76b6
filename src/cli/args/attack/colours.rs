//! Arguments of `attack colours`.

use std::path::PathBuf;

/// Make further flat colours of rendered views, without rendering: light adds up
#[derive(clap::Args)]
pub struct ColoursArgs {
    /// Frames with linear light, in three flat colours or more per view
    #[arg(value_name = "FRAMES")]
    pub frames: PathBuf,
    /// Flat colours as hex sRGB, as in c83214
    #[arg(long, value_name = "HEX", num_args = 1..)]
    pub flat: Vec<String>,
    /// And so many random ones
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=1000))]
    pub random: u32,
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Folder for the new frames
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// Print JSON instead of text
    #[arg(long)]
    pub json: bool,
}
