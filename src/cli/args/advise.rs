//! Arguments of `advise`.

use std::path::PathBuf;

use crate::cli::at_hand::Detectors;
use crate::cli::score as score_command;
use scaleproof_score as score;

/// Say which tag detector, solver, camera model, how many tags and which resolution are enough for a session, and whether findings depend on the definition of AP or on the box behind the truth.
///
/// No truth is needed: a tag is left out of each pose, and its corners are predicted. Advised is the smallest way that loses no photo, moves none to another bin, and predicts no worse than the most
/// accurate one.
#[derive(clap::Args)]
#[command(
    mut_arg("detector", |a| a.help("Detector whose findings are looked at; once for each, or a list with commas; none when none is named, unless --recorded is given")),
    mut_arg("recorded", |a| a.help("Look at the detections stored in the session instead of running detectors")),
)]
pub struct Args {
    /// The session's folder.
    pub session: PathBuf,
    #[command(flatten)]
    pub detectors: Detectors,
    /// The texture that the others are held against.
    #[arg(long, value_name = "NAME", default_value = score::BASE_VARIANT)]
    pub base: String,
    #[command(flatten)]
    pub effort: score_command::Effort,
    /// Folder for advice.html, advice.json and advice.toml, which `score --settings` takes.
    #[arg(short, long, alias = "out", value_name = "DIR")]
    pub output: PathBuf,
    /// Print advice.json instead of the tables.
    #[arg(long)]
    pub json: bool,
}
