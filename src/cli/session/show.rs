//! `scaleproof session show`: what is in a session, on one screen.

use std::collections::BTreeSet;
use std::convert::Infallible;
use std::io::Write;
use std::path::PathBuf;

use schemars::JsonSchema;
use serde::Serialize;

use crate::cli::{CommandResult, Outcome, advice, progress, sessions};
use scaleproof_core::{spelling, workers};
use scaleproof_detect::{Manifest, Recorded, Recording};
use scaleproof_photo::Photo;
use scaleproof_score::EvaluatedDetector;
use scaleproof_session::contents::{self, Contents, PhotoRead};
use scaleproof_session::{PhotoEntry, Session};

/// Show what is in a session: the scene, the camera, photos by texture and place, recordings, and what is amiss
#[derive(clap::Args)]
pub(crate) struct Args {
    /// The session's folder
    session: PathBuf,
    /// Print it as one JSON object
    #[arg(long)]
    json: bool,
}

/// All of `--json`.
#[derive(Serialize, JsonSchema)]
pub(in crate::cli) struct Page {
    #[serde(flatten)]
    contents: Contents,
    recordings: Vec<Stored>,
    /// What is amiss, as sentences.
    notes: Vec<String>,
}

/// A detector's recording.
#[derive(Serialize, JsonSchema)]
struct Stored {
    detector: String,
    /// Photos of the session that it has detections of.
    photos: usize,
}

pub(super) fn run(args: &Args, out: &mut dyn Write) -> CommandResult {
    let session = sessions::session(&args.session)?;
    let page = page(&session);
    if args.json {
        writeln!(out, "{}", serde_json::to_string_pretty(&page)?)?
    } else {
        write!(out, "{}", text(&page))?
    }
    Ok(Outcome::Done)
}

fn page(session: &Session) -> Page {
    let looks = looks(session);
    let contents = Contents::of(session, &looks);
    let (mut notes, mut recordings) = (Vec::new(), Vec::new());
    if let Some(first) = contents.unreadable.first() {
        let count = contents.unreadable.len();
        notes.push(format!(
            "{} cannot be read (the first: {})",
            spelling::count(count, "photo"),
            first.reason
        ));
    }
    notes.extend(contents::copies(session, &looks));
    notes.extend(session.camera.as_ref().and_then(|c| Some(c.guess?.caution())));
    let folder = EvaluatedDetector::recordings_of(&session.folder);
    for detector in Recording::names_in(&folder) {
        let opened = match Manifest::named(&detector) {
            Ok(manifest) => Recorded::open(&folder, &manifest).map(|recorded| recorded.recording),
            // A detector of the user's own: its manifest is not known here.
            Err(_) => Recording::open(&folder, &detector),
        };
        match opened {
            Err(e) => notes.push(advice::sentence(&e)),
            Ok(recording) => {
                let (stored, note) = stored(session, &looks, &recording);
                recordings.push(stored);
                notes.extend(note);
            }
        }
    }
    Page {
        contents,
        recordings,
        notes,
    }
}

/// Reads every photo, as far as its header.
fn looks(session: &Session) -> Vec<PhotoRead> {
    let look = |photo: &PhotoEntry| Photo::open(&session.photo_path(photo)).map(|photo| photo.sha256);
    let looks: Result<_, Infallible> = progress::photos("reading", session.photos.len())
        .during(|bar| workers::map(&session.photos, || Ok(()), |(), photo| Ok(look(photo)), || bar.inc(1)));
    looks.unwrap_or_else(|never| match never {})
}

/// A recording, and a note when photos have changed or come since.
fn stored(session: &Session, looks: &[PhotoRead], recording: &Recording) -> (Stored, Option<String>) {
    let hashes: BTreeSet<&str> = recording.photos.iter().map(|photo| photo.sha256.as_str()).collect();
    let is_there = |read: &PhotoRead| read.as_ref().is_ok_and(|hash| hashes.contains(hash.as_str()));
    let readable = session.photos.iter().zip(looks).filter(|(_, look)| look.is_ok());
    let without: Vec<_> = readable.filter(|(_, look)| !is_there(look)).collect();
    let detector = recording.detector.clone();
    let note = without.first().map(|(first, _)| {
        let count = without.len();
        format!(
            "{} {} no recorded detections of {detector} (the first: {}): {}",
            spelling::count(count, "photo"),
            spelling::choose(count, "has", "have"),
            first.file,
            spelling::choose(
                count,
                "it is new, or another file than the one recorded",
                "they are new, or other files than those recorded"
            )
        )
    });
    let photos = looks.iter().filter(|look| is_there(look)).count();
    (Stored { detector, photos }, note)
}

fn text(page: &Page) -> String {
    let mut lines = page.contents.lines(", see --json");
    let stored = |stored: &Stored| format!("{} ({})", stored.detector, spelling::count(stored.photos, "photo"));
    let stored: Vec<String> = page.recordings.iter().map(stored).collect();
    let stored = if stored.is_empty() {
        "nothing"
    } else {
        &stored.join(", ")
    };
    lines.push(contents::line("recorded", stored));
    lines.extend(page.notes.iter().map(|note| contents::line("note", note)));
    lines.join("\n") + "\n"
}
