//! `photos.csv`: one line per photo and detector, scored or not.

use serde_json::json;

use crate::evaluated::EvaluatedDetector;
use crate::figures::{Protocol, ScoredPhoto, Scores};
use crate::report::ReportError;
use crate::report::csv::rows::{Row, csv_of};
use crate::report::words::other_label;

pub fn render(scores: &Scores) -> Result<String, ReportError> {
    let scored = scores.photos.iter().flat_map(|photo| {
        let about = [&scores.sessions[photo.session].name, &photo.file, &photo.variant, ""];
        let detectors = scores.detectors.iter().enumerate();
        detectors.map(move |seen| line(scores, about, Some((photo, seen))))
    });
    let not_scored = scores.not_scored.iter();
    let not_scored = not_scored.map(|p| line(scores, [&p.session, &p.file, &p.variant, &p.reason], None));
    csv_of(scored.chain(not_scored))
}

/// Returns the line of a photo (session, file, variant, reason why it was left out) and of the detector that saw it; for a photo that none saw all
/// else is empty.
fn line<'a>(
    scores: &Scores,
    [session, file, variant, reason]: [&str; 4],
    seen: Option<(&ScoredPhoto, (usize, &EvaluatedDetector))>,
) -> Row<'a> {
    let p = seen.map(|(photo, _)| photo);
    let outcome = seen.map(|(photo, (index, _))| &photo.outcomes[index]);
    let other = seen.and_then(|(photo, (index, detector))| other_label(photo, index, detector));
    let (viewpoint, bin, truth) = (p.and_then(|p| p.viewpoint), p.and_then(|p| p.bin), p.map(|p| p.truth));
    let source = |p: &ScoredPhoto| if p.truth_given { "session" } else { "pose" };
    vec![
        ("photo_id", json!(p.map(|p| p.id))),
        ("session", json!(session)),
        ("file", json!(file)),
        ("variant", json!(variant)),
        ("place", json!(p.and_then(|p| p.place.as_deref()))),
        ("conditions", json!(p.map(conditions))),
        ("status", json!(if p.is_some() { "scored" } else { "not scored" })),
        ("reason", json!(reason)),
        ("azimuth_deg", json!(viewpoint.map(|v| v.azimuth_deg))),
        ("pitch_deg", json!(viewpoint.map(|v| v.pitch_deg))),
        ("distance_mm", json!(viewpoint.map(|v| v.distance_mm))),
        ("bin_azimuth_deg", json!(bin.map(|b| b.azimuth_deg))),
        ("bin_pitch_deg", json!(bin.map(|b| b.pitch_deg))),
        ("bin_distance_mm", json!(bin.map(|b| b.distance_mm))),
        ("tags", json!(p.map(|p| p.tags.len()))),
        ("rms_px", json!(p.and_then(|p| p.rms_px))),
        ("truth_source", json!(p.map(source))),
        ("truth_x1_px", json!(truth.map(|b| b.x1))),
        ("truth_y1_px", json!(truth.map(|b| b.y1))),
        ("truth_x2_px", json!(truth.map(|b| b.x2))),
        ("truth_y2_px", json!(truth.map(|b| b.y2))),
        (
            "detector",
            json!(seen.map(|(_, (_, detector))| &detector.manifest.name)),
        ),
        ("verdict", json!(outcome.map(|o| o.verdict))),
        ("confidence", json!(outcome.map(|o| o.confidence))),
        ("other_label", json!(other.map(|(label, _)| label))),
        ("other_confidence", json!(other.map(|(_, confidence)| confidence))),
        ("misclassified", json!(outcome.map(|o| o.is_misclassified()))),
        ("disappeared", json!(outcome.map(|o| o.has_disappeared()))),
        ("hallucinations", json!(outcome.map(|o| o.hallucinations))),
        ("false_positives", json!(outcome.map(|o| o.false_positives))),
        ("protocol", json!(p.and(scores.criteria.protocol).map(Protocol::name))),
    ]
}

/// Returns the conditions of a photo: `lux=300; weather=rain`.
fn conditions(photo: &ScoredPhoto) -> String {
    let all = photo.conditions.iter().map(|(name, value)| format!("{name}={value}"));
    all.collect::<Vec<_>>().join("; ")
}
