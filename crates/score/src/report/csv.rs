//! `photos.csv`: one line per photo and detector, scored or not.

use serde::Serialize;

use super::{ReportError, csv_of, other_label};
use crate::score::{EvaluatedDetector, NotScored, Protocol, ScoredPhoto, Scores, Verdict};

#[derive(Serialize, Default)]
struct PhotoRow<'a> {
    photo_id: Option<u64>,
    session: String,
    file: &'a str,
    variant: &'a str,
    place: &'a str,
    conditions: String,
    status: &'static str,
    reason: &'a str,
    azimuth_deg: Option<f64>,
    pitch_deg: Option<f64>,
    distance_mm: Option<f64>,
    bin_azimuth_deg: Option<f64>,
    bin_pitch_deg: Option<f64>,
    bin_distance_mm: Option<f64>,
    tags: Option<usize>,
    rms_px: Option<f64>,
    truth_source: &'static str,
    truth_x1_px: Option<f64>,
    truth_y1_px: Option<f64>,
    truth_x2_px: Option<f64>,
    truth_y2_px: Option<f64>,
    detector: &'a str,
    verdict: Option<Verdict>,
    confidence: Option<f64>,
    other_label: &'static str,
    other_confidence: Option<f64>,
    misclassified: Option<bool>,
    disappeared: Option<bool>,
    hallucinations: Option<usize>,
    false_positives: Option<usize>,
    protocol: &'static str,
}

pub(super) fn render(scores: &Scores) -> Result<String, ReportError> {
    let rows = scores.photos.iter().flat_map(|photo| {
        let detectors = scores.detectors.iter().enumerate();
        detectors.map(move |(index, detector)| scored(scores, photo, index, detector))
    });
    csv_of(rows.chain(scores.not_scored.iter().map(not_scored)))
}

fn scored<'a>(scores: &Scores, photo: &'a ScoredPhoto, index: usize, detector: &'a EvaluatedDetector) -> PhotoRow<'a> {
    let (viewpoint, bin, outcome) = (photo.viewpoint, photo.bin, &photo.outcomes[index]);
    let other = other_label(photo, index, detector);
    PhotoRow {
        photo_id: Some(photo.id),
        session: scores.sessions[photo.session].name.clone(),
        file: &photo.file,
        variant: &photo.variant,
        place: photo.place.as_deref().unwrap_or_default(),
        conditions: conditions(photo),
        status: "scored",
        azimuth_deg: viewpoint.map(|v| v.azimuth_deg),
        pitch_deg: viewpoint.map(|v| v.pitch_deg),
        distance_mm: viewpoint.map(|v| v.distance_mm),
        bin_azimuth_deg: bin.map(|b| b.azimuth_deg),
        bin_pitch_deg: bin.map(|b| b.pitch_deg),
        bin_distance_mm: bin.map(|b| b.distance_mm),
        tags: Some(photo.tags.len()),
        rms_px: photo.rms_px,
        truth_source: if photo.truth_given { "session" } else { "pose" },
        truth_x1_px: Some(photo.truth.x1),
        truth_y1_px: Some(photo.truth.y1),
        truth_x2_px: Some(photo.truth.x2),
        truth_y2_px: Some(photo.truth.y2),
        detector: &detector.manifest.name,
        verdict: Some(outcome.verdict),
        confidence: Some(outcome.confidence),
        other_label: other.map_or("", |(label, _)| label),
        other_confidence: other.map(|(_, confidence)| confidence),
        misclassified: Some(outcome.is_misclassified()),
        disappeared: Some(outcome.has_disappeared()),
        hallucinations: Some(outcome.hallucinations),
        false_positives: Some(outcome.false_positives),
        protocol: scores.criteria.protocol.map_or("", Protocol::name),
        ..PhotoRow::default()
    }
}

/// `lux=300; weather=rain`
fn conditions(photo: &ScoredPhoto) -> String {
    let all = photo.conditions.iter().map(|(name, value)| format!("{name}={value}"));
    all.collect::<Vec<_>>().join("; ")
}

fn not_scored(photo: &NotScored) -> PhotoRow<'_> {
    PhotoRow {
        session: photo.session.clone(),
        file: &photo.file,
        variant: &photo.variant,
        status: "not scored",
        reason: &photo.reason,
        ..PhotoRow::default()
    }
}
