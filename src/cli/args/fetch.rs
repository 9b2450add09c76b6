//! Arguments of `detectors fetch`.

use crate::cli::detectors::Folder;

/// Download weights, verify their SHA-256, go on with a broken download.
#[derive(clap::Args)]
pub struct FetchArgs {
    /// Which detectors; all when none is named.
    pub names: Vec<String>,
    #[command(flatten)]
    pub folder: Folder,
    /// One JSON object a line.
    #[arg(long)]
    pub json: bool,
}
