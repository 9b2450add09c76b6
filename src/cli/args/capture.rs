//! Arguments of `capture`.

use std::path::PathBuf;
use std::time::Duration;

use crate::cli::choice::completing;
use crate::cli::compare::inside;
use crate::cli::detectors;
use crate::cli::results::Programs;
use crate::cli::score as score_command;
use scaleproof_capture::{BinName, SourceName};
use scaleproof_core::message::Message;
use scaleproof_score as score;

/// When a capture may end before every view is there.
#[derive(clap::Args)]
pub struct DecidedArgs {
    /// End as soon as the mean confidence is shown to change, or a drop of --least is excluded, for every detector; the session has the photos of --base already. The test holds however often
    /// it is looked at (`compare --sequential`).
    #[arg(long, requires_all = ["detectors", "source"])]
    pub until_decided: bool,
    /// With --until-decided: a detector that looks at each pair; once for each, or a list with commas.
    #[arg(
        long = "detector",
        value_name = "NAME",
        value_delimiter = ',',
        requires = "until_decided"
    )]
    pub detectors: Vec<String>,
    #[command(flatten)]
    pub folder: detectors::Folder,
    #[command(flatten)]
    pub programs: Programs,
    /// With --until-decided: the texture that the photos are held against.
    #[arg(long, value_name = "NAME", default_value = score::BASE_VARIANT)]
    pub base: String,
    /// With --until-decided: the smallest drop of the mean confidence that matters. Between 0 and 1.
    #[arg(long, value_name = "DROP", requires = "until_decided", allow_negative_numbers = true, value_parser = inside)]
    pub least: Option<f64>,
    #[command(flatten)]
    pub effort: score_command::Effort,
}

/// The page in a browser.
#[derive(clap::Args)]
pub struct PageArgs {
    /// Show the capture as a page in a browser, which can also take back, send photos, and finish
    #[arg(long, conflicts_with = "headless")]
    pub page: bool,
    /// Serve the page at this port; 0 is any free one
    #[arg(long, value_name = "N", default_value_t = 8710, requires = "page")]
    pub port: u16,
    /// Let phones in the local network join by the QR code that is shown, instead of only browsers on this machine
    #[arg(long, requires = "page")]
    pub lan: bool,
}

/// Guide a photographer round the model: photos of every required view are taken into a session, the others get a sentence of advice.
///
/// Originals are never changed. A capture that was stopped goes on where it was when it is called again with the same session. Exit code
/// 0 when every view is there, else 2.
#[derive(clap::Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub struct Args {
    #[command(subcommand)]
    pub command: Option<Command>,
    #[command(flatten)]
    pub guided: Option<GuidedArgs>,
    // Not inside `GuidedArgs`: clap takes a group with another in it for absent.
    #[command(flatten)]
    pub wanted: ViewArgs,
    #[command(flatten)]
    pub decided: DecidedArgs,
    #[command(flatten)]
    pub browser: PageArgs,
}

#[derive(clap::Subcommand)]
pub enum Command {
    /// List the cameras of this machine
    ListCameras(ListArgs),
}

#[derive(clap::Args)]
pub struct ListArgs {
    /// One JSON object instead of text
    #[arg(long)]
    pub json: bool,
}

#[derive(clap::Args)]
pub struct GuidedArgs {
    /// Where photos come from: camera or camera:N (see list-cameras), http://… or rtsp://… (a camera that streams), watch:DIR
    /// (a folder that a phone or camera copies into), replay:DIR (the photos of --variant in a stored session), or upload (what browsers send to --page)
    #[arg(long, value_name = "SOURCE", required_unless_present_any = ["undo", "redo"], value_parser = completing(source, ["camera", "http://", "rtsp://", "watch:", "replay:", "upload"]), hide_possible_values = true)]
    pub source: Option<SourceName>,
    /// What stands on the table: scene.toml
    #[arg(long)]
    pub scene: PathBuf,
    /// Camera file, see `scaleproof camera`
    #[arg(long)]
    pub camera: PathBuf,
    /// The texture on the model
    #[arg(long, value_name = "NAME")]
    pub variant: String,
    /// Where the photos are taken; photos of one place are not independent
    #[arg(long, value_name = "NAME")]
    pub place: String,
    /// The session's folder; one that is there already is gone on with
    #[arg(short, long, value_name = "SESSION")]
    pub output: PathBuf,
    /// First take back the photos of a bin, named by its azimuth, or by azimuth/pitch/distance as in 90/15/850
    #[arg(long, value_name = "BIN")]
    pub redo: Option<BinName>,
    /// First take back the photo that was accepted last
    #[arg(long, conflicts_with = "redo")]
    pub undo: bool,
    /// Never wait: end when all photos of the watched folder were seen
    #[arg(long)]
    pub headless: bool,
    /// One JSON object a line
    #[arg(long)]
    pub json: bool,
    /// Replay in an order shuffled by this seed, instead of the session's
    #[arg(long, value_name = "SEED")]
    pub shuffle: Option<u64>,
    /// Replay so many photos a second, instead of as fast as possible
    #[arg(long, value_name = "N", value_parser = pace)]
    pub fps: Option<Duration>,
}

/// Which views are required: every azimuth bin at some pitches and distances, or another session's viewpoints.
#[derive(clap::Args)]
pub struct ViewArgs {
    /// Pitches of the scene's bins [default: the one nearest to 15°]
    #[arg(long, value_name = "DEG,…", value_delimiter = ',', allow_hyphen_values = true)]
    pub pitch_deg: Vec<f64>,
    /// Distances of the scene's bins [default: the middle one]
    #[arg(long, value_name = "MM,…", value_delimiter = ',')]
    pub distance_mm: Vec<f64>,
    /// The viewpoints of this session's normal photos, instead of bins
    #[arg(long, value_name = "SESSION", conflicts_with_all = ["pitch_deg", "distance_mm"])]
    pub pair_with: Option<PathBuf>,
    /// How far the azimuth may be off [default: a sixth of the bins' step, 8 at most; 3 with --pair-with]
    #[arg(long, value_name = "DEG", value_parser = positive)]
    pub azimuth_tolerance_deg: Option<f64>,
    /// How far the pitch may be off [default: 6; 3 with --pair-with]
    #[arg(long, value_name = "DEG", value_parser = positive)]
    pub pitch_tolerance_deg: Option<f64>,
    /// How far the distance may be off [default: a tenth of the nearest; a twentieth with --pair-with]
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    pub distance_tolerance_mm: Option<f64>,
}

fn positive(text: &str) -> Result<f64, String> {
    let value = text
        .parse::<f64>()
        .ok()
        .filter(|value| *value > 0.0 && value.is_finite());
    value.ok_or_else(|| "give a number above 0".into())
}

fn source(text: &str) -> Result<SourceName, String> {
    text.parse().map_err(|error: Message| format!("{error} (--page)"))
}

fn pace(text: &str) -> Result<Duration, String> {
    let fps = positive(text)?;
    Duration::try_from_secs_f64(1.0 / fps).map_err(|_| "give a larger number".into())
}
