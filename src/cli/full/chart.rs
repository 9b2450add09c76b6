//! `scaleproof chart`: methods against each other, on the same photos.

use crate::cli::answer::Named;
use crate::cli::answer::write_json;
use schemars::JsonSchema;
use schemars::schema_for;
use std::io::Write;
use std::path::{Path, PathBuf};

use clap::Subcommand;
use serde::Serialize;

use crate::cli::detectors::Folder;
use crate::cli::results::Results;
use crate::cli::{CommandResult, Outcome, Result, at_hand, progress};
use scaleproof_core::files;
use scaleproof_photo::photo::Photo;
use scaleproof_pose::locate::locate_photo;
use scaleproof_pose::tags::TagDetectorChoice;
use scaleproof_session::envelope::{self, EnvelopeShape};
use scaleproof_session::session::{PhotoEntry, Session};
use scaleproof_study::chart::locate::PhotoSample;
use scaleproof_study::chart::{
    capture, envelope as envelope_chart, locate, score as score_chart, stability, true_boxes, true_views,
};

/// Chart methods against each other, on the same photos
#[derive(clap::Args)]
pub(in crate::cli) struct Args {
    #[command(subcommand)]
    what: What,
}

#[derive(Subcommand)]
enum What {
    /// Every tag detector, solver and camera model: error against milliseconds against share answered
    Locate(LocateArgs),
    /// Every envelope that truth boxes are drawn around: IoU with the exact boxes against milliseconds
    Envelope(EnvelopeArgs),
    /// Drive every method from harmless to hopeless: error, share answered, share silently wrong
    Stability(StabilityArgs),
    /// Guided capture by every tag detector: milliseconds from frame to advice
    Capture(CaptureArgs),
    /// Scoring, stage by stage: where the milliseconds of a photo go, poses from tags and truth given
    Score(ScoreArgs),
}

#[derive(clap::Args)]
struct LocateArgs {
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
struct EnvelopeArgs {
    #[command(flatten)]
    on: ChartInput,
    /// The model's mesh, .glb, .obj, .stl or .ply, where the scene names none; without any, only the box is charted
    #[arg(long, value_name = "FILE")]
    mesh: Option<PathBuf>,
}

#[derive(clap::Args)]
struct StabilityArgs {
    #[command(flatten)]
    on: ChartInput,
    /// Simulated views at each amount of each condition
    #[arg(long, default_value_t = 300, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    views: u32,
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

#[derive(clap::Args)]
struct CaptureArgs {
    /// A session folder; its photos are the frames
    #[arg(long, value_name = "DIR")]
    session: PathBuf,
    /// Folder for the chart (SVG) and its numbers (JSON)
    #[arg(short, long, alias = "out", value_name = "DIR")]
    output: PathBuf,
    /// One JSON object instead of a table: the numbers, and the files that were written
    #[arg(long)]
    json: bool,
}

#[derive(clap::Args)]
struct ScoreArgs {
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
    /// Folder for the chart (SVG) and its numbers (JSON)
    #[arg(short, long, alias = "out", value_name = "DIR")]
    output: PathBuf,
    /// One JSON object instead of a table: the numbers, and the files that were written
    #[arg(long)]
    json: bool,
}

/// The photos and the truth about them.
#[derive(clap::Args)]
struct ChartInput {
    /// A session folder
    #[arg(long, value_name = "DIR")]
    session: PathBuf,
    /// The exact truth: JSON with azimuth, pitch and distance per photo; for envelopes, the box around the model's outline
    #[arg(long, value_name = "JSON")]
    truth: PathBuf,
    /// Folder for the charts (SVG) and their numbers (JSON)
    #[arg(short, long, alias = "out", value_name = "DIR")]
    output: PathBuf,
    /// One JSON object instead of a table: the numbers, and the files that were written
    #[arg(long)]
    json: bool,
}

/// Runs `scaleproof chart …`.
pub(in crate::cli) fn run(args: Args, out: &mut dyn Write) -> CommandResult {
    match args.what {
        What::Locate(args) => chart_locate(&args, out),
        What::Envelope(args) => chart_envelope(&args, out),
        What::Stability(args) => chart_stability(&args, out),
        What::Capture(args) => chart_capture(&args, out),
        What::Score(args) => chart_score(&args, out),
    }
}

/// The numbers of a chart, with what they were measured with.
#[derive(Serialize, JsonSchema)]
pub(in crate::cli) struct ChartNumbers<'a, R> {
    /// Version of the program.
    scaleproof: &'static str,
    /// Name of the session's folder.
    session: &'a str,
    /// File name and SHA-256.
    inputs: &'a [(String, String)],
    /// Names and libraries of the tag detectors.
    tag_detectors: Vec<String>,
    rows: &'a [R],
}

/// The seed of the copies that `chart locate` spoils.
const SPOILED_BY: u64 = 1;

fn chart_locate(args: &LocateArgs, out: &mut dyn Write) -> CommandResult {
    if !(0.1..=10.0).contains(&args.enlarge) {
        return Err(format!("photos cannot be enlarged {} times: give 0.1 to 10", args.enlarge).into());
    }
    let (session, samples) = load(&args.on)?;
    let samples = enlarged(samples, args.enlarge);
    let samples = match args.spoil {
        Some(copies) => stability::spoiled(&samples, &session.scene, copies, SPOILED_BY)?,
        None => samples,
    };
    let bar = progress::photos("measuring", samples.len() * locate::detectors(&session.scene).len());
    let rows = locate::measure(&samples, &session.scene, session.known_camera()?, || bar.inc(1))?;
    bar.finish_and_clear();
    let chart = ChartOutput {
        name: "locate",
        table: locate::table(&rows),
        drawn: vec![("", locate::draw(&rows))],
        numbers: numbers(&session, &[Some(&args.on.truth)], &rows)?,
    };
    chart.write(&args.on.output, args.on.json, out)
}

fn chart_envelope(args: &EnvelopeArgs, out: &mut dyn Write) -> CommandResult {
    let session = Session::open(&args.on.session)?;
    let model = &session.scene.model;
    let mesh_path = args.mesh.as_ref().or(session.mesh_path.as_ref());
    let mut outlines = vec![("box", EnvelopeShape::of_box(model))];
    if let Some(path) = mesh_path {
        let mesh = envelope::load(path, model)?;
        outlines.push(("hull", EnvelopeShape::hull(&mesh, model)));
        outlines.push(("mesh", EnvelopeShape::surface(&mesh, model)));
    }
    let (samples, not_located) = placed(&session, &args.on)?;
    let busy = progress::busy("measuring");
    let rows = envelope_chart::measure(&samples, &outlines, model.envelope.name());
    busy.finish_and_clear();
    for sentence in not_located {
        say!("not measured: {sentence}");
    }
    let inputs = [Some(args.on.truth.as_path()), args.mesh.as_deref()];
    let chart = ChartOutput {
        name: "envelope",
        table: envelope_chart::table(&rows),
        drawn: vec![("", envelope_chart::draw(&rows))],
        numbers: numbers(&session, &inputs, &rows)?,
    };
    chart.write(&args.on.output, args.on.json, out)
}

/// The photos of a session that the tags place, and a sentence about each of the others.
fn placed(session: &Session, on: &ChartInput) -> Result<(Vec<envelope_chart::LocatedSample>, Vec<String>)> {
    let names: Vec<&str> = session.photos.iter().map(|photo| photo.file.as_str()).collect();
    let truths = true_boxes(&on.truth, &names)?;
    let camera = session.known_camera()?;
    let mut tags = TagDetectorChoice::default().open(&session.scene.families())?;
    let bar = progress::photos("locating", names.len());
    let (mut samples, mut not_located) = (Vec::new(), Vec::new());
    for (entry, truth) in session.photos.iter().zip(truths) {
        let photo = Photo::open(&session.photo_path(entry))?;
        match locate_photo(&photo, &session.scene, camera, &mut tags)?.pose_and_camera() {
            Ok((located, fitted)) => samples.push(envelope_chart::LocatedSample {
                file: entry.file.clone(),
                pose: located.pose,
                camera: fitted.camera,
                truth,
            }),
            Err(reason) => not_located.push(format!("{}: {reason}", entry.file)),
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    match not_located.first() {
        Some(first) if samples.is_empty() => Err(format!("no photo has a pose; {first}").into()),
        _ => Ok((samples, not_located)),
    }
}

fn chart_stability(args: &StabilityArgs, out: &mut dyn Write) -> CommandResult {
    let (session, samples) = load(&args.on)?;
    let bar = progress::photos(
        "sweeping",
        stability::photo_steps(samples.len()) + stability::view_steps(),
    );
    let detectors = stability::detectors(&session.scene);
    let (scene, camera) = (&session.scene, session.known_camera()?);
    let photos = stability::on_photos(&samples, scene, camera, &detectors, args.seed, || bar.inc(1))?;
    let views = stability::on_views(scene, camera, args.views as usize, args.seed, || bar.inc(1));
    bar.finish_and_clear();
    let drawn = vec![
        ("-photos", stability::draw("Spoiled photos", &photos)),
        ("-views", stability::draw("Simulated views", &views)),
    ];
    let steps: Vec<_> = photos.into_iter().chain(views).collect();
    let chart = ChartOutput {
        name: "stability",
        table: stability::summary(&steps).to_string(),
        drawn,
        numbers: numbers(&session, &[Some(&args.on.truth)], &steps)?,
    };
    chart.write(&args.on.output, args.on.json, out)
}

fn chart_capture(args: &CaptureArgs, out: &mut dyn Write) -> CommandResult {
    let session = Session::open(&args.session)?;
    let read = |photo: &PhotoEntry| Ok((photo.file.clone(), files::read(&session.photo_path(photo))?));
    let frames: Vec<_> = session
        .photos
        .iter()
        .map(read)
        .collect::<Result<_, files::FileError>>()?;
    let bar = progress::photos("measuring", frames.len() * capture::ways(&session.scene).len());
    let rows = capture::measure(&frames, &session.scene, session.known_camera()?, || bar.inc(1))?;
    bar.finish_and_clear();
    let chart = ChartOutput {
        name: "capture",
        table: capture::table(&rows),
        drawn: vec![("", capture::draw(&rows))],
        numbers: numbers(&session, &[], &rows)?,
    };
    chart.write(&args.output, args.json, out)
}

fn chart_score(args: &ScoreArgs, out: &mut dyn Write) -> CommandResult {
    let session = Session::open(&args.session)?;
    let none = Results::default();
    let sessions = std::slice::from_ref(&session);
    let detectors = at_hand::evaluated(sessions, &args.detectors, false, &args.folder, &none)?;
    files::check_writable(&args.output)?;
    let rounds = args.rounds as usize;
    let ways = score_chart::ways(&session).len();
    let bar = progress::photos("timing", session.photos.len() * detectors.len() * ways * (rounds + 1));
    let rows = score_chart::measure(&session, detectors, rounds, || bar.inc(1))?;
    bar.finish_and_clear();
    let chart = ChartOutput {
        name: "score",
        table: score_chart::table(&rows),
        drawn: vec![("", score_chart::draw(&rows))],
        numbers: numbers(&session, &[], &rows)?,
    };
    chart.write(&args.output, args.json, out)
}

/// The session and its photos, decoded, with the truth about each.
fn load(on: &ChartInput) -> Result<(Session, Vec<PhotoSample>)> {
    let session = Session::open(&on.session)?;
    let names: Vec<&str> = session.photos.iter().map(|photo| photo.file.as_str()).collect();
    let truths = true_views(&on.truth, &names)?;
    let bar = progress::photos("reading", names.len());
    let samples = session.photos.iter().zip(truths).map(|(entry, truth)| {
        let photo = Photo::open(&session.photo_path(entry))?;
        bar.inc(1);
        Ok(PhotoSample {
            luma: photo.luma()?,
            turned_deg: photo.turned_deg,
            truth,
        })
    });
    let samples = samples.collect::<Result<Vec<_>>>()?;
    bar.finish_and_clear();
    Ok((session, samples))
}

fn enlarged(samples: Vec<PhotoSample>, factor: f64) -> Vec<PhotoSample> {
    if factor == 1.0 {
        return samples;
    }
    let side = |pixels: u32| (f64::from(pixels) * factor).round() as u32;
    samples
        .into_iter()
        .map(|sample| PhotoSample {
            luma: image::imageops::resize(
                &sample.luma,
                side(sample.luma.width()),
                side(sample.luma.height()),
                image::imageops::FilterType::CatmullRom,
            ),
            ..sample
        })
        .collect()
}

/// `read` are the files read besides the session's.
fn numbers<R: Serialize>(session: &Session, read: &[Option<&Path>], rows: &[R]) -> Result<String> {
    let mut inputs = session.hashes.clone();
    for path in read.iter().flatten() {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        inputs.push((name, files::sha256_hex(&files::read(path)?)));
    }
    Ok(serde_json::to_string_pretty(&ChartNumbers {
        scaleproof: env!("CARGO_PKG_VERSION"),
        session: &session.name,
        inputs: &inputs,
        tag_detectors: TagDetectorChoice::ALL
            .iter()
            .map(|choice| choice.provenance())
            .collect(),
        rows,
    })?)
}

/// What was measured.
struct ChartOutput {
    /// Of its files.
    name: &'static str,
    table: String,
    /// What follows the name, and the SVG.
    drawn: Vec<(&'static str, String)>,
    /// JSON.
    numbers: String,
}

impl ChartOutput {
    /// Writes `NAME.json` and `NAME….svg` into a folder, and says what they show.
    fn write(self, folder: &Path, is_json: bool, out: &mut dyn Write) -> CommandResult {
        let mut new = vec![(
            folder.join(format!("{}.json", self.name)),
            self.numbers.clone().into_bytes(),
        )];
        for (suffix, svg) in self.drawn {
            new.push((folder.join(format!("{}{suffix}.svg", self.name)), svg.into_bytes()));
        }
        files::replace_all_atomically(&new)?;
        if is_json {
            let numbers: serde_json::Value = serde_json::from_str(&self.numbers)?;
            write_json(&new, numbers, out)?;
            return Ok(Outcome::Done);
        }
        writeln!(out, "{}", self.table)?;
        for (path, _) in &new {
            writeln!(out, "{}", path.display())?;
        }
        Ok(Outcome::Done)
    }
}

/// The schemas of what these commands print and write.
pub(in crate::cli) fn schemas() -> Vec<Named> {
    vec![
        ("chart-capture", schema_for!(ChartNumbers<capture::CaptureRow>)),
        ("chart-envelope", schema_for!(ChartNumbers<envelope_chart::EnvelopeRow>)),
        ("chart-locate", schema_for!(ChartNumbers<locate::LocateRow>)),
        ("chart-score", schema_for!(ChartNumbers<score_chart::ScoreRow>)),
        ("chart-stability", schema_for!(ChartNumbers<stability::SweepStep>)),
    ]
}
