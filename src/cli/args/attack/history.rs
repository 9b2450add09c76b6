//! Arguments of `attack history`.

use std::path::PathBuf;

/// AP@0.5 on the held-out views against wall time, of several results of `attack run` and `attack baseline`
#[derive(clap::Args)]
pub struct HistoryArgs {
    /// Folders of results
    #[arg(value_name = "DIR", required = true)]
    pub results: Vec<PathBuf>,
    /// What `attack evaluate` wrote of the same patterns: a second chart has AP@0.5 in its photos against the time of each run
    #[arg(long, value_name = "DIR")]
    pub evaluation: Option<PathBuf>,
    /// Folder for the charts (SVG) and their numbers (JSON)
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// The histories as one JSON object instead of the table
    #[arg(long)]
    pub json: bool,
}
