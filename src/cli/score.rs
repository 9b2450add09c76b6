//! `scaleproof score`: how well do detectors see the model in these sessions?

use std::io::Write;
use std::path::{Path, PathBuf};

use super::{CommandResult, Outcome, detectors, progress};
use crate::detect::{Manifest, Recorded, RecordedPhoto, Recording, SCORE_FLOOR, SpeedError, Speeds, WeightFolders};
use crate::files::{self, FileError};
use crate::report;
use crate::score::{self, ApDefinition, Contestant, ContestantError, Criteria, ScoreError, Scores};
use crate::session::Session;

/// Score detectors on photo sessions: AP@0.5, hit rate and confidence per texture and viewing direction, with a report.
///
/// A photo that cannot be read or located is listed with its reason, and the others are scored.
#[derive(clap::Args)]
pub struct Args {
    /// Session folders (each with a session.json); name them before --detector.
    sessions: Vec<PathBuf>,
    /// Detector to score, see `scaleproof detectors list`; several may be named; all when none is.
    #[arg(long = "detector", value_name = "NAME", num_args = 1.., value_delimiter = ',')]
    detectors: Vec<String>,
    #[command(flatten)]
    folder: detectors::Folder,
    /// AP definition: coco-101, all-point, voc-11 or yolov5-ramp.
    #[arg(long, value_name = "NAME", default_value = ApDefinition::Coco101.name(), value_parser = ApDefinition::from_name)]
    ap: ApDefinition,
    /// A detection counts as a hit, a misclassification or a hallucination from this confidence up.
    #[arg(long, value_name = "C", default_value_t = score::HIT_CONFIDENCE)]
    confidence: f64,
    /// Folder for report.html, table.tex, summary.json, photos.csv, figures.csv and the COCO files.
    #[arg(long)]
    out: PathBuf,
    /// File of `scaleproof detectors speed`: the report then charts AP against milliseconds a photo.
    #[arg(long, value_name = "FILE")]
    speed: Option<PathBuf>,
    /// Score the detections stored in the sessions instead of running the detectors.
    #[arg(long)]
    recorded: bool,
    /// Store the detections in each session's folder `recorded`, for later runs with --recorded.
    #[arg(long, conflicts_with = "recorded")]
    record: bool,
}

pub fn run(args: Args, out: &mut dyn Write) -> CommandResult {
    if args.sessions.is_empty() {
        return Err("no session is named: name the session folders first, then --detector and the others".into());
    }
    let criteria = criteria(&args)?;
    let sessions = args
        .sessions
        .iter()
        .map(|s| Session::open(s))
        .collect::<Result<Vec<_>, _>>()?;
    let manifests = detectors::chosen(&args.detectors)?;
    let folders = if args.recorded {
        None
    } else {
        Some(args.folder.folders()?)
    };
    let contestants = contestants(&sessions, manifests, folders.as_ref())?;
    check_places(&args, &sessions)?;
    let speeds = args
        .speed
        .as_deref()
        .map(|path| speeds(path, &contestants))
        .transpose()?;
    let scores = score_with_progress(sessions, contestants)?.judged_by(criteria);
    let page = report::write(&args.out, &scores, speeds.as_ref())?;
    if args.record {
        record(&scores)?;
    }
    caution(&scores);
    writeln!(out, "{}", report::summary_table(&scores))?;
    writeln!(out, "truth boxes: {}", report::truth_boxes(&scores))?;
    writeln!(out, "report: {}", page.display())?;
    Ok(Outcome::Done)
}

fn criteria(args: &Args) -> Result<Criteria, String> {
    if !(SCORE_FLOOR..=1.0).contains(&args.confidence) {
        let confidence = args.confidence;
        return Err(format!(
            "--confidence is {confidence}: give a number from {SCORE_FLOOR} to 1"
        ));
    }
    Ok(Criteria {
        ap: args.ap,
        hit_confidence: args.confidence,
    })
}

/// Finds out before the work that its results can be stored.
fn check_places(args: &Args, sessions: &[Session]) -> Result<(), FileError> {
    let recordings = sessions
        .iter()
        .filter(|_| args.record)
        .map(|s| Contestant::recordings_of(&s.folder));
    recordings
        .chain([args.out.clone()])
        .try_for_each(|folder| files::check_writable(&folder))
}

/// The named detectors, with the weights in `folders`, or played back from the sessions' recordings without any.
pub fn contestants(
    sessions: &[Session],
    manifests: Vec<Manifest>,
    folders: Option<&WeightFolders>,
) -> Result<Vec<Contestant>, ContestantError> {
    let class = sessions
        .first()
        .map(|s| s.scene.model.class.clone())
        .unwrap_or_default();
    let places: Vec<&Path> = sessions.iter().map(|s| s.folder.as_path()).collect();
    let contestant = |m| match folders {
        Some(folders) => Contestant::live(m, folders, &class),
        None => Contestant::recorded(m, &places, &class),
    };
    manifests.into_iter().map(contestant).collect()
}

/// The times of these detectors in a file.
pub fn speeds(path: &Path, contestants: &[Contestant]) -> Result<Speeds, SpeedError> {
    let manifests: Vec<&Manifest> = contestants.iter().map(|c| &c.manifest).collect();
    Speeds::open(path, &manifests)
}

/// Scores sessions and shows how far it has come.
pub fn score_with_progress(sessions: Vec<Session>, contestants: Vec<Contestant>) -> Result<Scores, ScoreError> {
    let bar = progress::photos("scoring", sessions.iter().map(|s| s.photos.len()).sum());
    let scores = score::score(sessions, contestants, || bar.inc(1));
    bar.finish_and_clear();
    scores
}

/// Says on standard error which photos were left out, and what to know before believing the figures.
pub fn caution(scores: &Scores) {
    for photo in &scores.not_scored {
        eprintln!("not scored: {}/{}: {}", photo.session, photo.file, photo.reason);
    }
    for caution in &scores.cautions {
        eprintln!("note: {caution}");
    }
}

fn record(scores: &Scores) -> Result<(), Box<dyn std::error::Error>> {
    for (session_index, session) in scores.sessions.iter().enumerate() {
        let photos: Vec<_> = scores.photos.iter().filter(|p| p.session == session_index).collect();
        for (index, contestant) in scores.contestants.iter().enumerate() {
            let recording = Recording {
                detector: contestant.manifest.name.clone(),
                weights_sha256: contestant.manifest.weights.sha256.clone(),
                results_sha256: String::new(),
                scaleproof: env!("CARGO_PKG_VERSION").to_owned(),
                runtime: scores.runtime.clone().unwrap_or_default(),
                score_floor: SCORE_FLOOR,
                photos: photos
                    .iter()
                    .map(|p| RecordedPhoto {
                        id: p.id,
                        file: p.file.clone(),
                        sha256: p.sha256.clone(),
                    })
                    .collect(),
            };
            let detections: Vec<_> = photos.iter().map(|p| p.detections[index].as_slice()).collect();
            let folder = Contestant::recordings_of(&session.folder);
            Recorded::save(&folder, &contestant.manifest, recording, &detections)?;
        }
    }
    Ok(())
}
