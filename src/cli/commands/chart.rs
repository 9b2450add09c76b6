//! `scaleproof chart`: methods against each other, on the same photos.

use std::io::Write;
use std::path::{Path, PathBuf};

use crate::cli::answer::{Named, named};
use crate::cli::args::chart::{CaptureArgs, Command, EnvelopeArgs, LocateArgs, ScoreArgs, SigmaArgs, StabilityArgs};
use crate::cli::results::Results;
use crate::cli::{CommandResult, Result, at_hand, progress};
use scaleproof_core::files;
use scaleproof_core::spelling::count;
use scaleproof_pose::locate::Solver;
use scaleproof_session::{PhotoEntry, Session};
use scaleproof_study::chart::{ChartNumbers, capture, envelope, locate, score, sigma, stability};

/// Runs `scaleproof chart …`.
pub fn run(command: Command, out: &mut dyn Write) -> CommandResult {
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

pub fn schemas() -> Vec<Named> {
    vec![
        named::<ChartNumbers<capture::CaptureRow>>("chart-capture"),
        named::<ChartNumbers<envelope::EnvelopeRow>>("chart-envelope"),
        named::<ChartNumbers<locate::LocateRow>>("chart-locate"),
        named::<ChartNumbers<score::ScoreRow>>("chart-score"),
        named::<ChartNumbers<sigma::SigmaRow>>("chart-sigma"),
        named::<ChartNumbers<stability::SweepStep>>("chart-stability"),
    ]
}
