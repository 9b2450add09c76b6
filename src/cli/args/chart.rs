//! Arguments of `chart`.

use std::path::{Path, PathBuf};

use clap::Subcommand;

use crate::cli::Result;
use crate::cli::detectors::Folder;
use crate::cli::sessions::among_photos;
use scaleproof_core::files;

#[derive(Subcommand)]
pub enum Command {
    /// Every tag detector, solver and camera model: error against milliseconds against share answered
    Locate(LocateArgs),
    /// Every envelope that truth boxes are drawn around: IoU with the exact boxes against milliseconds
    Envelope(EnvelopeArgs),
    /// Drive every method from harmless to hopeless: error, share answered, share silently wrong
    Stability(StabilityArgs),
    /// Whether the stated σ of poses is true, by how many tags they rest on: share of errors within so many σ
    Sigma(SigmaArgs),
    /// Guided capture by every tag detector: milliseconds from frame to advice
    Capture(CaptureArgs),
    /// Scoring, stage by stage: where the milliseconds of a photo go, poses from tags and truth given
    Score(ScoreArgs),
}

#[derive(clap::Args)]
pub struct LocateArgs {
    #[command(flatten)]
    pub on: ChartInput,
    /// Enlarge the photos by this factor first, as if a camera of more pixels had taken them
    #[arg(long, default_value_t = 1.0, allow_negative_numbers = true)]
    pub enlarge: f64,
    /// Measure on so many spoiled copies of each photo instead: blurred, moved, noisy, dark or bright, covered, compressed
    #[arg(long, value_name = "COPIES", value_parser = clap::value_parser!(u32).range(1..=100))]
    pub spoil: Option<u32>,
}

#[derive(clap::Args)]
pub struct EnvelopeArgs {
    #[command(flatten)]
    pub on: ChartInput,
    /// The model's mesh, .glb, .obj, .stl or .ply, where the scene names none; without any, only the box is charted
    #[arg(long, value_name = "FILE")]
    pub mesh: Option<PathBuf>,
}

#[derive(clap::Args)]
pub struct StabilityArgs {
    #[command(flatten)]
    pub on: ChartInput,
    /// Simulated views at each amount of each condition
    #[arg(long, default_value_t = 300, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub views: u32,
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
}

#[derive(clap::Args)]
pub struct SigmaArgs {
    /// Session folders; those of one name are charted together
    #[arg(long = "session", value_name = "DIR", required = true)]
    pub sessions: Vec<PathBuf>,
    /// The truth about each session: JSON with azimuth, pitch and distance per photo, and their own `sigma` where they are not exact
    #[arg(long = "truth", value_name = "JSON", required = true)]
    pub truths: Vec<PathBuf>,
    /// Simulated views of the first session for each number of tags; 0: the photos alone
    #[arg(long, default_value_t = 500, value_parser = clap::value_parser!(u32).range(0..=100_000))]
    pub views: u32,
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    #[command(flatten)]
    pub into: ChartFiles,
}

#[derive(clap::Args)]
pub struct CaptureArgs {
    /// A session folder; its photos are the frames
    #[arg(long, value_name = "DIR")]
    pub session: PathBuf,
    #[command(flatten)]
    pub into: ChartFiles,
}

#[derive(clap::Args)]
pub struct ScoreArgs {
    /// A session folder; every detector looks at its photos alone
    #[arg(long, value_name = "DIR")]
    pub session: PathBuf,
    /// Detectors: names of the list or manifests (`detectors list`); otherwise those whose weights are present
    #[arg(long = "detector", value_name = "NAME", value_delimiter = ',')]
    pub detectors: Vec<String>,
    #[command(flatten)]
    pub folder: Folder,
    /// Each photo's fastest of so many rounds counts
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=100))]
    pub rounds: u32,
    #[command(flatten)]
    pub into: ChartFiles,
}

/// The photos and the truth about them.
#[derive(clap::Args)]
#[command(mut_arg("output", |output| output.help("Folder for the charts (SVG) and their numbers (JSON)")))]
pub struct ChartInput {
    /// A session folder
    #[arg(long, value_name = "DIR")]
    pub session: PathBuf,
    /// The exact truth: JSON with azimuth, pitch and distance per photo; for envelopes, the box around the model's outline
    #[arg(long, value_name = "JSON")]
    pub truth: PathBuf,
    #[command(flatten)]
    pub into: ChartFiles,
}

/// Where a chart goes.
#[derive(clap::Args)]
pub struct ChartFiles {
    /// Folder for the chart (SVG) and its numbers (JSON)
    #[arg(short, long, alias = "out", value_name = "DIR")]
    pub output: PathBuf,
    /// One JSON object instead of a table: the numbers, and the files that were written
    #[arg(long)]
    pub json: bool,
}

impl Command {
    /// The folder for the charts, and the sessions that they are of.
    pub fn places(&self) -> (&Path, &[PathBuf]) {
        let one = std::slice::from_ref;
        let (into, sessions) = match self {
            Command::Locate(args) => (&args.on.into, one(&args.on.session)),
            Command::Envelope(args) => (&args.on.into, one(&args.on.session)),
            Command::Stability(args) => (&args.on.into, one(&args.on.session)),
            Command::Sigma(args) => (&args.into, &args.sessions[..]),
            Command::Capture(args) => (&args.into, one(&args.session)),
            Command::Score(args) => (&args.into, one(&args.session)),
        };
        (&into.output, sessions)
    }

    /// Finds out before anything is measured whether the charts can be written.
    pub fn check_output(&self) -> Result<()> {
        let (output, sessions) = self.places();
        files::check_writable(output)?;
        match sessions.iter().any(|session| files::is_same(output, session)) {
            true => Err(among_photos("charts", output).into()),
            false => Ok(()),
        }
    }
}
