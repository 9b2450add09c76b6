//! `session from-video` as JSON and in words.

use std::collections::BTreeMap;
use std::path::PathBuf;

use schemars::JsonSchema;
use serde::Serialize;

use crate::cli::session;
use scaleproof_capture::Measures;
use scaleproof_core::geometry::angle::direction_text;
use scaleproof_core::spelling::count;
use scaleproof_core::statistics::upper_median;
use scaleproof_film::choose::Refusal;
use scaleproof_film::keep::PairDifference;
use scaleproof_film::session::{Film, Filmed};
use scaleproof_pose::locate::Sigma;
use scaleproof_pose::scene::{Bin, Viewpoint};

/// `session from-video --json`.
#[derive(Serialize, JsonSchema)]
pub struct Answer {
    /// The session's folder.
    session: PathBuf,
    /// The `session.json` in it.
    file: PathBuf,
    video: VideoFacts,
    /// Every so-manieth frame was looked at.
    every: u64,
    /// How many frames were looked at.
    frames: usize,
    /// How many of them have a pose.
    located: usize,
    /// How many of them were fit to be chosen.
    fit: usize,
    /// The others by reason.
    refused: BTreeMap<Refusal, usize>,
    /// The photos that were made.
    chosen: Vec<ChosenFrame>,
    /// Bins of the scene without a photo of this video.
    empty_bins: Vec<Bin>,
    /// The texture whose photos frames were paired with; `null` where there is none.
    paired_with: Option<String>,
    /// Its photos without a pair in this video.
    unpaired: Vec<String>,
    /// The chosen frames, small, on one image.
    contact_sheet: PathBuf,
    /// Where the camera stood in all frames.
    coverage: PathBuf,
    /// What to know before the photos are believed, as sentences.
    notes: Vec<String>,
}

/// A video, as its header says.
#[derive(Serialize, JsonSchema)]
struct VideoFacts {
    name: String,
    sha256: String,
    /// Of an upright frame.
    width_px: u32,
    /// Of an upright frame.
    height_px: u32,
    /// Clockwise.
    turned_deg: u32,
    codec: String,
    duration_s: Option<f64>,
    /// SDR, HLG or PQ.
    range: &'static str,
}

/// A frame that is a photo now.
#[derive(Serialize, JsonSchema)]
struct ChosenFrame {
    /// From the session's folder.
    file: String,
    /// Its number in the video, from 0.
    frame: u64,
    time_s: f64,
    bin: Bin,
    viewpoint: Viewpoint,
    sigma: Sigma,
    gates: Measures,
    pair: Option<Pair>,
}

/// The photo that a frame is a pair of.
#[derive(Serialize, JsonSchema)]
struct Pair {
    file: String,
    /// From the photo's viewpoint to the frame's.
    difference: PairDifference,
}

impl Answer {
    pub fn of(film: &Film, filmed: &Filmed) -> Answer {
        let (walk, video) = (&film.walk, &film.walk.video);
        let chosen = filmed.kept.iter().map(|one| ChosenFrame {
            file: format!("{}/{}", filmed.inside, one.file),
            frame: one.frame.number,
            time_s: one.frame.time_s,
            bin: one.bin,
            viewpoint: one.viewpoint,
            sigma: one.sigma,
            gates: one.measures,
            pair: one.pair.map(|(place, difference)| Pair {
                file: walk.targets.files[place].clone(),
                difference,
            }),
        });
        Answer {
            session: film.request.folder.clone(),
            file: filmed.file.clone(),
            video: VideoFacts {
                name: walk.name.clone(),
                sha256: walk.sha256.clone(),
                width_px: video.width,
                height_px: video.height,
                turned_deg: video.turned_deg,
                codec: video.codec.clone(),
                duration_s: video.duration_s,
                range: video.range.name(),
            },
            every: film.part.every,
            frames: filmed.looks.len(),
            located: filmed.looks.iter().filter(|look| look.shows.is_ok()).count(),
            fit: filmed.looks.len() - filmed.refused.values().sum::<usize>(),
            refused: filmed.refused.clone(),
            chosen: chosen.collect(),
            empty_bins: walk.empty_bins(&filmed.kept),
            paired_with: Some(walk.targets.variant.clone()).filter(|variant| !variant.is_empty()),
            unpaired: walk.unpaired(&filmed.kept),
            contact_sheet: filmed.contact_sheet.clone(),
            coverage: filmed.coverage.clone(),
            notes: walk.notes(&filmed.kept),
        }
    }
}

/// The film's frames, and the session with all of its photos.
pub fn in_words(answer: &Answer, filmed: &Filmed) -> String {
    let variants = session::by_variant(filmed.photos.iter().map(|photo| &*photo.variant));
    words(answer) + &session::in_words(&filmed.file, filmed.photos.len(), &variants, &answer.session)
}

fn words(answer: &Answer) -> String {
    let mut lines = vec![format!(
        "{}: {} looked at, {} located, {} fit, {} chosen",
        answer.video.name,
        count(answer.frames, "frame"),
        answer.located,
        answer.fit,
        answer.chosen.len()
    )];
    let refused: Vec<String> = answer
        .refused
        .iter()
        .map(|(why, count)| format!("{} {count}", why.name()))
        .collect();
    if !refused.is_empty() {
        lines.push(format!("refused: {}", refused.join(", ")));
    }
    for one in &answer.chosen {
        let (v, s) = (&one.viewpoint, &one.sigma);
        let blur = one
            .gates
            .blur_px
            .map_or(String::new(), |px| format!(", blur {px:.2} px"));
        let pair = one.pair.as_ref().map_or(String::new(), |pair| {
            format!(", {:.2}° from {}", pair.difference.apart_deg, pair.file)
        });
        lines.push(format!(
            "  {}: frame {} at {:.2} s, {}° ± {:.2}° / {:.1}° / {:.0} mm{blur}{pair}",
            one.file,
            one.frame,
            one.time_s,
            direction_text(v.azimuth_deg, 2),
            s.azimuth_deg,
            v.pitch_deg,
            v.distance_mm
        ));
    }
    if let Some(variant) = &answer.paired_with {
        let apart: Vec<f64> = answer
            .chosen
            .iter()
            .filter_map(|one| Some(one.pair.as_ref()?.difference.apart_deg))
            .collect();
        let most = apart.iter().copied().fold(0.0, f64::max);
        let median = upper_median(&apart).unwrap_or(0.0);
        lines.push(format!(
            "{} with {variant}: viewpoints differ by {median:.2}° (median), {most:.2}° at most",
            count(apart.len(), "pair")
        ));
    }
    if !answer.unpaired.is_empty() {
        lines.push(format!("without a pair: {}", answer.unpaired.join(", ")));
    }
    if !answer.empty_bins.is_empty() && answer.paired_with.is_none() {
        let names = answer
            .empty_bins
            .iter()
            .map(|b| format!("{:.0}°/{:.0}°/{:.0} mm", b.azimuth_deg, b.pitch_deg, b.distance_mm));
        lines.push(format!(
            "bins without a frame: {}",
            names.collect::<Vec<_>>().join(", ")
        ));
    }
    lines.extend(answer.notes.iter().map(|note| format!("note: {note}")));
    lines.push(format!(
        "{}, {}",
        answer.contact_sheet.display(),
        answer.coverage.display()
    ));
    lines.join("\n") + "\n"
}
