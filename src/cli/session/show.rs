//! `scaleproof session show`: what is in a session, on one screen.

use schemars::JsonSchema;
use std::collections::BTreeSet;
use std::convert::Infallible;
use std::io::Write;
use std::path::PathBuf;

use serde::Serialize;

use crate::cli::{CommandResult, Outcome, advice, progress, sessions};
use scaleproof_core::{spelling, workers};
use scaleproof_detect::{Manifest, Recorded, Recording};
use scaleproof_photo::photo::Photo;
use scaleproof_score::score::EvaluatedDetector;
use scaleproof_session::session::{Contents, Look, PhotoEntry, Session};

/// So many groups of photos are listed; the rest is counted.
const MOST_GROUPS: usize = 16;

/// Show what is in a session: the scene, the camera, photos by texture and place, recordings, and what is amiss
#[derive(clap::Args)]
pub(super) struct Args {
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
    notes.extend(copies(session, &looks));
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
fn looks(session: &Session) -> Vec<Look> {
    let bar = progress::photos("reading", session.photos.len());
    let look = |photo: &PhotoEntry| Photo::open(&session.photo_path(photo)).map(|photo| photo.sha256);
    let looks: Result<_, Infallible> =
        workers::map(&session.photos, || Ok(()), |(), photo| Ok(look(photo)), || bar.inc(1));
    bar.finish_and_clear();
    looks.unwrap_or_else(|never| match never {})
}

/// Photos that are byte for byte the same.
fn copies(session: &Session, looks: &[Look]) -> Option<String> {
    let mut seen = BTreeSet::new();
    let known = session
        .photos
        .iter()
        .zip(looks)
        .filter_map(|(photo, look)| Some((photo, look.as_ref().ok()?)));
    let mut copies = known.filter(|(_, hash)| !seen.insert(*hash));
    let (first, _) = copies.next()?;
    let count = 1 + copies.count();
    Some(format!(
        "{} {} (the first: {})",
        spelling::count(count, "photo"),
        spelling::choose(
            count,
            "is a byte-for-byte copy of another",
            "are byte-for-byte copies of others"
        ),
        first.file
    ))
}

/// A recording, and a note when photos have changed or come since.
fn stored(session: &Session, looks: &[Look], recording: &Recording) -> (Stored, Option<String>) {
    let hashes: BTreeSet<&str> = recording.photos.iter().map(|photo| photo.sha256.as_str()).collect();
    let is_there = |look: &Look| look.as_ref().is_ok_and(|hash| hashes.contains(hash.as_str()));
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
    let Contents {
        scene, camera, photos, ..
    } = &page.contents;
    let mut lines = vec![format!(
        "{}: {}",
        page.contents.session,
        spelling::count(*photos, "photo")
    )];
    let mut line = |name: &str, what: String| lines.push(format!("{name:<9}{what}"));
    let [length, width, height] = scene.size_mm;
    line(
        "model",
        format!(
            "{}, 1:{}, {length} × {width} × {height} mm, detected as {}; truth envelope: {}",
            scene.model, scene.scale, scene.class, scene.truth_envelope
        ),
    );
    line("tags", format!("{} ({})", scene.tags, scene.tag_families.join(", ")));
    line(
        "bins",
        format!(
            "{}: azimuth every {}°, pitch {}°, distance {} mm",
            scene.bins.count,
            scene.bins.azimuth_deg,
            list(&scene.bins.pitch_deg),
            list(&scene.bins.distance_mm)
        ),
    );
    line(
        "camera",
        match camera {
            None => "none: every photo has its truth box and viewpoint".into(),
            Some(c) => format!(
                "{} × {} px, focal length {:.0} px{}",
                c.width_px,
                c.height_px,
                (c.fx_px + c.fy_px) / 2.0,
                c.guessed_within_percent.map_or(String::new(), |percent| format!(
                    ", guessed from EXIF (within {percent} %)"
                ))
            ),
        },
    );
    for (i, group) in page.contents.groups.iter().take(MOST_GROUPS).enumerate() {
        let place = group
            .place
            .as_deref()
            .map_or("no place".into(), |place| format!("place {place}"));
        let name = if i == 0 { "photos" } else { "" };
        line(name, format!("{} {}, {place}", group.photos, group.variant));
    }
    if let Some(more) = page
        .contents
        .groups
        .len()
        .checked_sub(MOST_GROUPS)
        .filter(|more| *more > 0)
    {
        line("", format!("… and {}, see --json", spelling::count(more, "more group")));
    }
    if page.contents.with_truth > 0 {
        line(
            "truth",
            format!(
                "{} {} own truth box",
                spelling::count(page.contents.with_truth, "photo"),
                spelling::choose(page.contents.with_truth, "has its", "have their")
            ),
        );
    }
    line("recorded", recordings(page));
    for note in &page.notes {
        line("note", note.clone());
    }
    lines.join("\n") + "\n"
}

fn recordings(page: &Page) -> String {
    let stored: Vec<_> = page
        .recordings
        .iter()
        .map(|stored| format!("{} ({})", stored.detector, spelling::count(stored.photos, "photo")))
        .collect();
    if stored.is_empty() {
        "nothing".into()
    } else {
        stored.join(", ")
    }
}

fn list(values: &[f64]) -> String {
    values.iter().map(f64::to_string).collect::<Vec<_>>().join(", ")
}
