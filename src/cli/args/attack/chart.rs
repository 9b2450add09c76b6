//! Arguments of `attack chart`.

use std::path::PathBuf;

/// Every surrogate renderer on frames: error in flat colours it has not seen, and with patterns, against milliseconds
#[derive(clap::Args)]
pub struct ChartArgs {
    /// A folder of frames
    #[arg(value_name = "FRAMES")]
    pub frames: PathBuf,
    /// The colours models are fitted to, as hex: the first two, the first three, …
    #[arg(long, value_name = "HEX", num_args = 2..=8, default_values = ["000000", "ffffff", "808080"])]
    pub reference: Vec<String>,
    /// Trained networks to put beside them (attack train-dtn)
    #[arg(long, value_name = "FILE", num_args = 1..)]
    pub network: Vec<PathBuf>,
    /// Folder for the charts (SVG) and its numbers (JSON)
    #[arg(short, long, alias = "out", value_name = "DIR")]
    pub output: PathBuf,
    /// Print renderers.json instead of the table
    #[arg(long)]
    pub json: bool,
}
