//! `scaleproof capture`: walk round the model once and have every view.

mod decided;
mod interrupt;
mod page;
mod terminal;

use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Duration;

use schemars::JsonSchema;
use serde::Serialize;

use self::decided::Question;
use self::interrupt::Interruptible;
use self::terminal::TerminalLog;
use crate::cli::answer::told;
use crate::cli::choice::completing;
use crate::cli::full::interrupt::Opening;
use crate::cli::resolve::names::check_names;
use crate::cli::{CommandResult, Outcome, Result};
use scaleproof_capture::page::{CaptureInfo, Page};
use scaleproof_capture::{
    BinName, Capture, FrameLine, FrameSource, Guidance, Judge, LiveCamera, Replay, SourceName, Store, Target,
    Tolerance, Watch, interrupt_programs, live::list_cameras, pair, stream,
};
use scaleproof_core::files;
use scaleproof_core::message::Message;
use scaleproof_core::spelling::count;
use scaleproof_pose::camera::Camera;
use scaleproof_pose::scene::{Bins, Scene, Viewpoint};
use scaleproof_pose::tags::TagDetectorChoice;

/// Guide a photographer round the model: photos of every required view are taken into a session, the others get a sentence of advice.
///
/// Originals are never changed. A capture that was stopped goes on where it was when it is called again with the same session. Exit code
/// 0 when every view is there, else 2.
#[derive(clap::Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub(in crate::cli) struct Args {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    guided: Option<GuidedArgs>,
    // Not inside `GuidedArgs`: clap takes a group with another in it for absent.
    #[command(flatten)]
    wanted: ViewArgs,
    #[command(flatten)]
    decided: decided::Args,
    #[command(flatten)]
    browser: page::Args,
}

#[derive(clap::Subcommand)]
enum Command {
    /// List the cameras of this machine
    ListCameras(ListArgs),
}

#[derive(clap::Args)]
struct ListArgs {
    /// One JSON object instead of text
    #[arg(long)]
    json: bool,
}

#[derive(clap::Args)]
struct GuidedArgs {
    /// Where photos come from: camera or camera:N (see list-cameras), http://… or rtsp://… (a camera that streams), watch:DIR
    /// (a folder that a phone or camera copies into), replay:DIR (the photos of --variant in a stored session), or upload (what browsers send to --page)
    #[arg(long, value_name = "SOURCE", required_unless_present_any = ["undo", "redo"], value_parser = completing(source, ["camera", "http://", "rtsp://", "watch:", "replay:", "upload"]), hide_possible_values = true)]
    source: Option<SourceName>,
    /// What stands on the table: scene.toml
    #[arg(long)]
    scene: PathBuf,
    /// Camera file, see `scaleproof camera`
    #[arg(long)]
    camera: PathBuf,
    /// The texture on the model
    #[arg(long, value_name = "NAME")]
    variant: String,
    /// Where the photos are taken; photos of one place are not independent
    #[arg(long, value_name = "NAME")]
    place: String,
    /// The session's folder; one that is there already is gone on with
    #[arg(short, long, value_name = "SESSION")]
    output: PathBuf,
    /// First take back the photos of a bin, named by its azimuth, or by azimuth/pitch/distance as in 90/15/850
    #[arg(long, value_name = "BIN")]
    redo: Option<BinName>,
    /// First take back the photo that was accepted last
    #[arg(long, conflicts_with = "redo")]
    undo: bool,
    /// Never wait: end when all photos of the watched folder were seen
    #[arg(long)]
    headless: bool,
    /// One JSON object a line
    #[arg(long)]
    json: bool,
    /// Replay in an order shuffled by this seed, instead of the session's
    #[arg(long, value_name = "SEED")]
    shuffle: Option<u64>,
    /// Replay so many photos a second, instead of as fast as possible
    #[arg(long, value_name = "N", value_parser = pace)]
    fps: Option<Duration>,
}

/// Which views are required: every azimuth bin at some pitches and distances, or another session's viewpoints.
#[derive(clap::Args)]
struct ViewArgs {
    /// Pitches of the scene's bins [default: the one nearest to 15°]
    #[arg(long, value_name = "DEG,…", value_delimiter = ',', allow_hyphen_values = true)]
    pitch_deg: Vec<f64>,
    /// Distances of the scene's bins [default: the middle one]
    #[arg(long, value_name = "MM,…", value_delimiter = ',')]
    distance_mm: Vec<f64>,
    /// The viewpoints of this session's normal photos, instead of bins
    #[arg(long, value_name = "SESSION", conflicts_with_all = ["pitch_deg", "distance_mm"])]
    pair_with: Option<PathBuf>,
    /// How far the azimuth may be off [default: a sixth of the bins' step, 8 at most; 3 with --pair-with]
    #[arg(long, value_name = "DEG", value_parser = positive)]
    azimuth_tolerance_deg: Option<f64>,
    /// How far the pitch may be off [default: 6; 3 with --pair-with]
    #[arg(long, value_name = "DEG", value_parser = positive)]
    pitch_tolerance_deg: Option<f64>,
    /// How far the distance may be off [default: a tenth of the nearest; a twentieth with --pair-with]
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    distance_tolerance_mm: Option<f64>,
}

/// The last line of `--json`.
#[derive(Serialize, JsonSchema)]
pub(in crate::cli) struct CaptureSummary {
    /// How many views are required.
    targets: usize,
    /// How many of them are there.
    filled: usize,
    /// The views that are still open.
    open: Vec<Viewpoint>,
}

/// The last line of `--json` of a capture that the answer ended (`--until-decided`).
#[derive(Serialize, JsonSchema)]
pub(in crate::cli) struct Decided {
    /// How many views are required.
    targets: usize,
    /// How many of them are there.
    filled: usize,
    /// Always true.
    decided: bool,
}

pub(in crate::cli) fn run(args: Args, out: &mut dyn Write) -> CommandResult {
    match (args.command, args.guided) {
        (Some(Command::ListCameras(args)), _) => list(&args, out),
        (None, Some(guided)) => guide(&guided, (&args.wanted, &args.decided), &args.browser, out),
        (None, None) => Err("say where photos come from with --source (see --help)".into()),
    }
}

fn list(args: &ListArgs, out: &mut dyn Write) -> CommandResult {
    let cameras = list_cameras().map_err(|reason| format!("the cameras cannot be listed: {reason}"))?;
    let cameras = cameras.into_iter().map(|camera| NamedCamera {
        source: format!("camera:{}", camera.number),
        name: camera.name,
        description: camera.description,
    });
    let cameras: Vec<NamedCamera> = cameras.collect();
    let lines = cameras
        .iter()
        .map(|c| format!("{}  {}  ({})", c.source, c.name, c.description));
    let words = if cameras.is_empty() {
        "no camera is there: plug one in, or watch the folder of a phone (--source watch:DIR)".to_owned()
    } else {
        lines.collect::<Vec<_>>().join("\n")
    };
    told(args.json, Cameras { cameras }, words, out)
}

/// `capture list-cameras --json`.
#[derive(Serialize, JsonSchema)]
pub(in crate::cli) struct Cameras {
    cameras: Vec<NamedCamera>,
}

#[derive(Serialize, JsonSchema)]
struct NamedCamera {
    /// What `--source` takes, such as `camera:0`.
    source: String,
    /// As the camera calls itself.
    name: String,
    description: String,
}

fn guide(
    args: &GuidedArgs,
    (wanted, decided): (&ViewArgs, &decided::Args),
    browser: &page::Args,
    out: &mut dyn Write,
) -> CommandResult {
    check_names(&args.variant, &args.place)?;
    check_output(args)?;
    // However this ends: the threads that own them are left behind.
    let _programs = Interrupting;
    let scene = Scene::open(&args.scene)?;
    let camera = Camera::open(&args.camera)?;
    let guidance = wanted.guidance(&scene.bins)?;
    let opening = Opening::new();
    let source = match &args.source {
        Some(SourceName::Upload) if !browser.page => {
            return Err("photos are sent to the page: add --page, or --page --lan for phones".into());
        }
        Some(name) => open_source(name, args, &camera)?,
        None => None,
    };
    drop(opening);
    let is_stream = source.as_ref().is_some_and(|source| source.is_stream());
    let judge = Judge::new(&scene, TagDetectorChoice::default(), is_stream)?;
    let page = if browser.page {
        let at_once = || {
            interrupt_programs();
            std::process::exit(130)
        };
        Some(Page::open(browser.port, browser.lan, &args.output, at_once).map_err(page::advised)?)
    } else {
        None
    };
    // The capture goes on with it, and writes it anew at each photo.
    files::inputs::own(&args.output.join("session.json"));
    let question = decided.question(args.output.clone(), &args.variant, &args.place)?;
    let store = Store::open(&args.output, &args.scene, &args.camera, &args.variant)?;
    let camera_px = [camera.width, camera.height];
    let mut capture = Capture::new(guidance, judge, store, camera, &args.variant, &args.place);
    if browser.page && !is_stream {
        capture = capture.with_film(Judge::new(&scene, TagDetectorChoice::default(), true)?);
    }
    take_back(args, &scene, &mut capture, out)?;
    begin(args, &capture, out)?;
    let is_decided = match (page, source) {
        (Some(page), source) => {
            let about = CaptureInfo {
                variant: args.variant.clone(),
                place: args.place.clone(),
                source: args.source.as_ref().map_or("none", SourceName::kind),
                is_stream,
                is_paired: wanted.pair_with.is_some(),
                camera_px,
            };
            page::introduce(&page, args.json, out)?;
            let terminal = TerminalLog::new(args.json, is_stream, out);
            page::follow(
                page,
                (&mut capture, &scene),
                source,
                &about,
                question.as_ref(),
                terminal,
            )?
        }
        (None, Some(source)) => {
            let terminal = TerminalLog::new(args.json, is_stream, out);
            follow(source, (args, question.as_ref()), &mut capture, terminal)?
        }
        (None, None) => false,
    };
    if is_decided {
        enough(&capture, args.json, out)
    } else {
        finish(&capture, args.json, out)
    }
}

/// Finds out before anything is made that nothing is written among the originals.
fn check_output(args: &GuidedArgs) -> Result<(), String> {
    let same = |folder: &Path| files::is_same(folder, &args.output);
    match &args.source {
        Some(name) if name.folder().is_some_and(same) => Err(format!(
            "{} is both the source and the session: capture into another folder",
            args.output.display()
        )),
        _ => Ok(()),
    }
}

/// `None` for photos that only browsers send.
fn open_source(name: &SourceName, args: &GuidedArgs, camera: &Camera) -> Result<Option<Box<dyn FrameSource + Send>>> {
    match name {
        SourceName::Replay(folder) => {
            let pace = args.fps.unwrap_or_default();
            let replay = Replay::open(folder, &args.variant, args.shuffle, pace)?;
            Ok(Some(Box::new(replay)))
        }
        _ if args.shuffle.is_some() || args.fps.is_some() => {
            Err("--shuffle and --fps are for replay: sources: leave them out".into())
        }
        SourceName::Watch(folder) => Ok(Some(Box::new(Watch::open(folder, args.headless)?))),
        SourceName::Camera(number) => Ok(Some(Box::new(LiveCamera::open(*number, camera)?))),
        SourceName::Stream(address) => Ok(Some(Box::new(stream::open(address, camera)?))),
        SourceName::Upload => Ok(None),
    }
}

/// Asks the programs that read for a source to end, when it is dropped.
struct Interrupting;

impl Drop for Interrupting {
    fn drop(&mut self) {
        interrupt_programs();
    }
}

fn take_back(args: &GuidedArgs, scene: &Scene, capture: &mut Capture, out: &mut dyn Write) -> Result<()> {
    let photos = match (&args.redo, args.undo) {
        (Some(meant), _) => capture.redo(scene, |bin| meant.names(bin))?,
        (None, true) => capture.undo()?.into_iter().collect(),
        (None, false) => return Ok(()),
    };
    if photos.is_empty() {
        if let Some(meant) = &args.redo {
            check_planned(meant, capture)?;
        }
        say!("note: there is no photo of {} to take back", args.variant);
    }
    let mut terminal = TerminalLog::new(args.json, false, out);
    photos.iter().try_for_each(|photo| terminal.taken_back(photo))?;
    Ok(())
}

/// A bin that no view falls into is mistyped.
fn check_planned(meant: &BinName, capture: &Capture) -> Result<()> {
    let targets = capture.guidance().targets();
    if targets.iter().any(|target| meant.names(&target.bin)) {
        return Ok(());
    }
    let name = |target: &Target| {
        format!(
            "{}/{}/{}",
            target.bin.azimuth_deg, target.bin.pitch_deg, target.bin.distance_mm
        )
    };
    let mut bins: Vec<String> = targets.iter().map(name).collect();
    bins.dedup();
    Err(format!(
        "no view is of the bin that --redo names: the bins of the views are {}",
        bins.join(", ")
    )
    .into())
}

/// Says what the capture waits for, before anything happens; programs read it in the summary.
fn begin(args: &GuidedArgs, capture: &Capture, out: &mut dyn Write) -> std::io::Result<()> {
    let guidance = capture.guidance();
    let (Some(first), Some(source), false) = (guidance.open().next(), &args.source, args.json) else {
        return Ok(());
    };
    let ((filled, all), place) = (guidance.filled_of_all(), first.in_words());
    let (open, views) = (all - filled, count(all, "view"));
    let views = if filled == 0 {
        format!("{views} to take; start {place}")
    } else {
        format!("{open} of {views} still open; go on {place}")
    };
    let how = match source {
        SourceName::Watch(folder) if args.headless => format!("looking at the photos in {}", folder.display()),
        SourceName::Watch(folder) => format!("copy photos into {}; Ctrl-C ends", folder.display()),
        SourceName::Replay(folder) => format!("replaying the photos of {}", folder.display()),
        SourceName::Camera(_) | SourceName::Stream(_) => "walk round the model with the camera; Ctrl-C ends".to_owned(),
        SourceName::Upload => "send photos to the page".to_owned(),
    };
    writeln!(out, "{views}; {how}")?;
    out.flush()
}

/// Shows the capture every frame until all views are there, the question is decided, the source ends, or somebody presses Ctrl-C. Whether it is decided.
fn follow(
    source: Box<dyn FrameSource + Send>,
    (args, question): (&GuidedArgs, Option<&Question>),
    capture: &mut Capture,
    mut terminal: TerminalLog,
) -> Result<bool> {
    let mut is_decided = asked(question, capture, &mut terminal)?;
    let mut source = Interruptible::new(source);
    let mut settings = None;
    while !is_decided && !capture.guidance().is_finished() {
        let Some((frame, set)) = source.next()? else { break };
        if settings != set {
            settings = set;
            settings.iter().for_each(|settings| terminal.set(settings));
            capture.set_camera_settings(settings.clone());
        }
        let answer = capture.see(&frame)?;
        terminal.seen(&frame.name, &answer, capture.guidance(), false)?;
        if answer.verdict.is_ok() {
            is_decided = asked(question, capture, &mut terminal)?;
        }
    }
    if source.was_interrupted() {
        say!("stopped; the same command with -o {} goes on", args.output.display());
    }
    Ok(is_decided)
}

/// Whether the pairs are enough.
fn asked(question: Option<&Question>, capture: &Capture, terminal: &mut TerminalLog) -> Result<bool> {
    let pairs = question.map(|question| question.ask(capture.guidance(), terminal));
    Ok(pairs.transpose()?.is_some_and(|pairs| pairs.is_decided))
}

/// The end of a capture whose question is decided: open views are not needed.
fn enough(capture: &Capture, json: bool, out: &mut dyn Write) -> CommandResult {
    let (filled, all) = capture.guidance().filled_of_all();
    let words = format!("decided; {} of {} not needed", all - filled, count(all, "view"));
    let decided = Decided {
        targets: all,
        filled,
        decided: true,
    };
    told(json, decided, words, out)
}

fn finish(capture: &Capture, json: bool, out: &mut dyn Write) -> CommandResult {
    let guidance = capture.guidance();
    let open: Vec<&Target> = guidance.open().collect();
    let (filled, all) = guidance.filled_of_all();
    if json {
        let summary = CaptureSummary {
            targets: all,
            filled,
            open: open.iter().map(|target| target.viewpoint).collect(),
        };
        writeln!(out, "{}", serde_json::to_string(&summary)?)?;
    } else if open.is_empty() {
        writeln!(out, "all {all} views are there")?;
    } else {
        let names: Vec<String> = open.iter().map(ToString::to_string).collect();
        writeln!(out, "{filled} of {all} views are there; open: {}", names.join(", "))?;
    }
    Ok(if open.is_empty() {
        Outcome::Done
    } else {
        Outcome::SomeInputBad
    })
}

impl ViewArgs {
    fn guidance(&self, bins: &Bins) -> Result<Guidance> {
        // Not as the other tolerances: lengths are read as all lengths are, in any unit.
        if let Some(mm) = self.distance_tolerance_mm.filter(|mm| !(*mm > 0.0 && mm.is_finite())) {
            return Err(format!("--distance-tolerance-mm is {mm}: give a length above 0").into());
        }
        let (viewpoints, tolerance) = match &self.pair_with {
            Some(session) => {
                let (viewpoints, faults) = pair::viewpoints(session, TagDetectorChoice::default())?;
                faults.iter().for_each(|fault| say!("note: no target for {fault}"));
                let tolerance = Tolerance::of_pairs(&viewpoints);
                (viewpoints, tolerance)
            }
            None => {
                let views = bins.photographed(&self.pitch_deg, &self.distance_mm)?;
                let distances: Vec<f64> = views.iter().map(|view| view.distance_mm).collect();
                let tolerance = Tolerance::of_bins(bins, &distances);
                (views, tolerance)
            }
        };
        let tolerance = Tolerance {
            azimuth_deg: self.azimuth_tolerance_deg.unwrap_or(tolerance.azimuth_deg),
            pitch_deg: self.pitch_tolerance_deg.unwrap_or(tolerance.pitch_deg),
            distance_mm: self.distance_tolerance_mm.unwrap_or(tolerance.distance_mm),
        };
        Ok(Guidance::at(&viewpoints, tolerance, bins))
    }
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

/// `capture --json`: one object a line for each frame, for what else happens, and one at the end.
#[derive(JsonSchema)]
#[schemars(untagged)]
#[expect(dead_code, reason = "each line is printed as its own type")]
pub(in crate::cli) enum Line<'a> {
    Page(page::Address),
    Frame(FrameLine<'a>),
    TakenBack(terminal::TakenBack),
    Standing(terminal::StandingLine),
    Decided(Decided),
    End(CaptureSummary),
}
