//! `scaleproof chart`: methods against each other, on the same photos.

use std::io::Write;
use std::path::{Path, PathBuf};

use clap::Subcommand;
use serde::Serialize;

use crate::cli::answer::{Named, named};
use crate::cli::answer::{told, written};
use crate::cli::detectors::Folder;
use crate::cli::results::Results;
use crate::cli::sessions::among_photos;
use crate::cli::{CommandResult, Result, at_hand, progress};
use scaleproof_core::files;
use scaleproof_core::spelling::count;
use scaleproof_pose::locate::Solver;
use scaleproof_session::{PhotoEntry, Session};
use scaleproof_study::chart::locate::PhotoSample;
use scaleproof_study::chart::{ChartNumbers, capture, envelope, locate, score, sigma, stability};

#[derive(Subcommand)]
pub(in crate::cli) enum Command {
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
pub(in crate::cli) struct LocateArgs {
    #[command(flatten)]
    on: ChartInput,
    /// Enlarge the photos by this factor first, as if a camera of more pixels had taken them
    #[arg(long, default_value_t = 1.0, allow_negative_numbers = true)]
    enlarge: f64,
    /// Measure on so many spoiled copies of each photo instead: blurred, moved, noisy, dark or bright, covered, compressed
    #[arg(long, value_name = "COPIES", value_parser = clap::value_parser!(u32).range(1..=100))]
    spoil: Option<u32>,
}

#[derive(clap::Args)]
pub(in crate::cli) struct EnvelopeArgs {
    #[command(flatten)]
    on: ChartInput,
    /// The model's mesh, .glb, .obj, .stl or .ply, where the scene names none; without any, only the box is charted
    #[arg(long, value_name = "FILE")]
    mesh: Option<PathBuf>,
}

#[derive(clap::Args)]
pub(in crate::cli) struct StabilityArgs {
    #[command(flatten)]
    on: ChartInput,
    /// Simulated views at each amount of each condition
    #[arg(long, default_value_t = 300, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    views: u32,
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

#[derive(clap::Args)]
pub(in crate::cli) struct SigmaArgs {
    /// Session folders; those of one name are charted together
    #[arg(long = "session", value_name = "DIR", required = true)]
    sessions: Vec<PathBuf>,
    /// The truth about each session: JSON with azimuth, pitch and distance per photo, and their own `sigma` where they are not exact
    #[arg(long = "truth", value_name = "JSON", required = true)]
    truths: Vec<PathBuf>,
    /// Simulated views of the first session for each number of tags; 0: the photos alone
    #[arg(long, default_value_t = 500, value_parser = clap::value_parser!(u32).range(0..=100_000))]
    views: u32,
    #[arg(long, default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    into: ChartFiles,
}

#[derive(clap::Args)]
pub(in crate::cli) struct CaptureArgs {
    /// A session folder; its photos are the frames
    #[arg(long, value_name = "DIR")]
    session: PathBuf,
    #[command(flatten)]
    into: ChartFiles,
}

#[derive(clap::Args)]
pub(in crate::cli) struct ScoreArgs {
    /// A session folder; every detector looks at its photos alone
    #[arg(long, value_name = "DIR")]
    session: PathBuf,
    /// Detectors: names of the list or manifests (`detectors list`); otherwise those whose weights are present
    #[arg(long = "detector", value_name = "NAME", value_delimiter = ',')]
    detectors: Vec<String>,
    #[command(flatten)]
    folder: Folder,
    /// Each photo's fastest of so many rounds counts
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=100))]
    rounds: u32,
    #[command(flatten)]
    into: ChartFiles,
}

/// The photos and the truth about them.
#[derive(clap::Args)]
#[command(mut_arg("output", |output| output.help("Folder for the charts (SVG) and their numbers (JSON)")))]
struct ChartInput {
    /// A session folder
    #[arg(long, value_name = "DIR")]
    session: PathBuf,
    /// The exact truth: JSON with azimuth, pitch and distance per photo; for envelopes, the box around the model's outline
    #[arg(long, value_name = "JSON")]
    truth: PathBuf,
    #[command(flatten)]
    into: ChartFiles,
}

/// Where a chart goes.
#[derive(clap::Args)]
struct ChartFiles {
    /// Folder for the chart (SVG) and its numbers (JSON)
    #[arg(short, long, alias = "out", value_name = "DIR")]
    output: PathBuf,
    /// One JSON object instead of a table: the numbers, and the files that were written
    #[arg(long)]
    json: bool,
}

impl Command {
    /// The folder for the charts, and the sessions that they are of.
    fn places(&self) -> (&Path, &[PathBuf]) {
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
    fn check_output(&self) -> Result<()> {
        let (output, sessions) = self.places();
        files::check_writable(output)?;
        match sessions.iter().any(|session| files::is_same(output, session)) {
            true => Err(among_photos("charts", output).into()),
            false => Ok(()),
        }
    }
}

/// Runs `scaleproof chart …`.
pub(in crate::cli) fn run(command: Command, out: &mut dyn Write) -> CommandResult {
    command.check_output()?;
    match command {
        Command::Locate(args) => chart_locate(&args, out),
        Command::Envelope(args) => chart_envelope(&args, out),
        Command::Stability(args) => chart_stability(&args, out),
        Command::Sigma(args) => chart_sigma(&args, out),
        Command::Capture(args) => chart_capture(&args, out),
        Command::Score(args) => chart_score(&args, out),
    }
}

/// The seed of the copies that `chart locate` spoils.
const SPOILED_BY: u64 = 1;

fn chart_locate(args: &LocateArgs, out: &mut dyn Write) -> CommandResult {
    if !(0.1..=10.0).contains(&args.enlarge) {
        return Err(format!("photos cannot be enlarged {} times: give 0.1 to 10", args.enlarge).into());
    }
    let (session, samples) = args.on.samples()?;
    let enlarged = samples.into_iter().map(|sample| sample.enlarged(args.enlarge));
    let mut samples: Vec<_> = enlarged.collect();
    if let Some(copies) = args.spoil {
        samples = stability::spoiled(&samples, &session.scene, copies, SPOILED_BY)?;
    }
    let camera = session.known_camera()?;
    let bar = progress::photos("measuring", samples.len() * locate::detectors(&session.scene).len());
    let rows = bar.during(|bar| locate::measure(&samples, &session.scene, camera, || bar.inc(1)))?;
    let numbers = ChartNumbers::new(&session, &[&args.on.truth], &rows)?;
    let drawn = [("locate.svg", locate::draw(&rows))];
    args.on
        .into
        .write("locate.json", &numbers, &drawn, &locate::table(&rows), out)
}

fn chart_envelope(args: &EnvelopeArgs, out: &mut dyn Write) -> CommandResult {
    let session = Session::open(&args.on.session)?;
    let model = &session.scene.model;
    let mesh = args.mesh.as_ref().or(session.mesh_path.as_ref());
    let shapes = envelope::envelopes(mesh.map(PathBuf::as_path), model)?;
    let (samples, not_located) = progress::photos("locating", session.photos.len())
        .during(|bar| envelope::placed(&session, &args.on.truth, || bar.inc(1)))?;
    let busy = progress::busy("measuring");
    let rows = envelope::measure(&samples, &shapes, model.envelope.name());
    busy.finish_and_clear();
    for sentence in not_located {
        say!("not measured: {sentence}");
    }
    let read: Vec<&Path> = [&args.on.truth]
        .into_iter()
        .chain(&args.mesh)
        .map(PathBuf::as_path)
        .collect();
    let numbers = ChartNumbers::new(&session, &read, &rows)?;
    let drawn = [("envelope.svg", envelope::draw(&rows))];
    args.on
        .into
        .write("envelope.json", &numbers, &drawn, &envelope::table(&rows), out)
}

fn chart_stability(args: &StabilityArgs, out: &mut dyn Write) -> CommandResult {
    let (session, samples) = args.on.samples()?;
    let (scene, camera) = (&session.scene, session.known_camera()?);
    let steps = stability::photo_steps(samples.len()) + stability::view_steps();
    let detectors = stability::detectors(scene);
    let (photos, views) = progress::photos("sweeping", steps).during(|bar| -> Result<_> {
        let photos = stability::on_photos(&samples, scene, camera, &detectors, args.seed, || bar.inc(1))?;
        let views = stability::on_views(scene, camera, &Solver::all(), (args.views as usize, args.seed), || {
            bar.inc(1)
        });
        Ok((photos, views))
    })?;
    let drawn = [
        ("stability-photos.svg", stability::draw("Spoiled photos", &photos)),
        ("stability-views.svg", stability::draw("Simulated views", &views)),
    ];
    let steps: Vec<_> = photos.into_iter().chain(views).collect();
    let numbers = ChartNumbers::new(&session, &[&args.on.truth], &steps)?;
    let table = stability::summary(&steps).to_string();
    args.on.into.write("stability.json", &numbers, &drawn, &table, out)
}

fn chart_sigma(args: &SigmaArgs, out: &mut dyn Write) -> CommandResult {
    if args.sessions.len() != args.truths.len() {
        let (sessions, truths) = (args.sessions.len(), args.truths.len());
        let reason = format!(
            "there are {} and {}: give a --truth for each --session, in their order",
            count(sessions, "session"),
            count(truths, "truth file")
        );
        return Err(reason.into());
    }
    let open = |(session, truth): (&PathBuf, &PathBuf)| Ok((Session::open(session)?, truth.clone()));
    let sessions = args
        .sessions
        .iter()
        .zip(&args.truths)
        .map(open)
        .collect::<Result<Vec<_>>>()?;
    let (views, seed) = (args.views as usize, args.seed);
    let rows = progress::photos("measuring", sigma::photos(&sessions, views))
        .during(|bar| sigma::measure(&sessions, views, seed, || bar.inc(1)))?;
    let opened: Vec<&Session> = sessions.iter().map(|(session, _)| session).collect();
    let read: Vec<&Path> = args.truths.iter().map(PathBuf::as_path).collect();
    let numbers = ChartNumbers::over(&opened, &read, &rows)?;
    let drawn = [("sigma.svg", sigma::draw(&rows))];
    args.into
        .write("sigma.json", &numbers, &drawn, &sigma::table(&rows), out)
}

fn chart_capture(args: &CaptureArgs, out: &mut dyn Write) -> CommandResult {
    let session = Session::open(&args.session)?;
    let read = |photo: &PhotoEntry| Ok((photo.file.clone(), files::read(&session.photo_path(photo))?));
    let frames = session.photos.iter().map(read).collect::<Result<Vec<_>>>()?;
    let camera = session.known_camera()?;
    let rows = progress::photos("measuring", frames.len() * capture::ways(&session.scene).len())
        .during(|bar| capture::measure(&frames, &session.scene, camera, || bar.inc(1)))?;
    let numbers = ChartNumbers::new(&session, &[], &rows)?;
    let drawn = [("capture.svg", capture::draw(&rows))];
    args.into
        .write("capture.json", &numbers, &drawn, &capture::table(&rows), out)
}

fn chart_score(args: &ScoreArgs, out: &mut dyn Write) -> CommandResult {
    let session = Session::open(&args.session)?;
    let sessions = std::slice::from_ref(&session);
    let detectors = at_hand::evaluated(sessions, &args.detectors, false, &args.folder, &Results::default())?;
    files::check_writable(&args.into.output)?;
    let (rounds, ways) = (args.rounds as usize, score::ways(&session).len());
    let bar = progress::photos("timing", session.photos.len() * detectors.len() * ways * (rounds + 1));
    let rows = bar.during(|bar| score::measure(&session, detectors, rounds, || bar.inc(1)))?;
    let numbers = ChartNumbers::new(&session, &[], &rows)?;
    let drawn = [("score.svg", score::draw(&rows))];
    args.into
        .write("score.json", &numbers, &drawn, &score::table(&rows), out)
}

impl ChartInput {
    fn samples(&self) -> Result<(Session, Vec<PhotoSample>)> {
        let session = Session::open(&self.session)?;
        let samples = progress::photos("reading", session.photos.len())
            .during(|bar| PhotoSample::of_session(&session, &self.truth, || bar.inc(1)))?;
        Ok((session, samples))
    }
}

impl ChartFiles {
    fn write(
        &self,
        name: &str,
        numbers: &impl Serialize,
        drawn: &[(&str, String)],
        table: &str,
        out: &mut dyn Write,
    ) -> CommandResult {
        let mut new = vec![(self.output.join(name), serde_json::to_vec_pretty(numbers)?)];
        let svg = |(name, svg): &(&str, String)| (self.output.join(name), svg.clone().into_bytes());
        new.extend(drawn.iter().map(svg));
        files::replace_all_atomically(&self.output, &new)?;
        let paths = new.iter().map(|(path, _)| format!("\n{}", path.display()));
        let words = table.to_owned() + &paths.collect::<String>();
        told(self.json, written(&new, numbers), words, out)
    }
}

pub(in crate::cli) fn schemas() -> Vec<Named> {
    vec![
        named::<ChartNumbers<capture::CaptureRow>>("chart-capture"),
        named::<ChartNumbers<envelope::EnvelopeRow>>("chart-envelope"),
        named::<ChartNumbers<locate::LocateRow>>("chart-locate"),
        named::<ChartNumbers<score::ScoreRow>>("chart-score"),
        named::<ChartNumbers<sigma::SigmaRow>>("chart-sigma"),
        named::<ChartNumbers<stability::SweepStep>>("chart-stability"),
    ]
}
