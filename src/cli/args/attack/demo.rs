//! Arguments of `attack demo`.

use std::path::PathBuf;

use crate::cli::detectors::Folder;

/// From stored frames to a pattern against YOLOX-Nano, its printable template, and how often it is still detected:
/// minutes on two cores
///
/// Without YOLOX-Nano's weights the pattern is made against the project's own small detector.
#[derive(clap::Args)]
pub struct DemoArgs {
    /// Folder for the pattern, its card, its history and its template
    #[arg(short, long, alias = "out", value_name = "DIR", default_value = "out/attack_demo")]
    pub output: PathBuf,
    #[command(flatten)]
    pub folder: Folder,
}
