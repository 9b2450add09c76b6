//! Outcome of one detector on one photo.

use serde::Serialize;

use crate::evaluated::EvaluatedDetector;
use crate::figures::Thresholds;
use scaleproof_core::geometry::BoxPx;
use scaleproof_detect::Detection;

/// Verdict, with the colour of the border that the paper draws around photos, the worst first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Red: the model was not found as its class.
    Missed,
    /// Yellow: found as its class, but another label lies on it too.
    FoundWithOther,
    /// Green: found as its class.
    Found,
}

#[derive(Debug, Clone, PartialEq)]
pub struct PhotoOutcome {
    /// Highest confidence among detections of the class that overlap the truth enough; 0 for a miss.
    pub confidence: f64,
    /// The most confident other label on the model at hit confidence: (label, confidence).
    pub other: Option<(usize, f64)>,
    pub verdict: Verdict,
    /// Detections of the class at hit confidence that lie elsewhere: their overlap with the truth is too small.
    pub hallucinations: usize,
    /// Detections of the class at hit confidence but for the one that finds the model: hallucinations and second boxes on the model.
    pub false_positives: usize,
}

impl PhotoOutcome {
    /// Judges the detections of a photo against the model's truth box and the labels that count as it; those below the hit confidence matter for
    /// `confidence` alone.
    pub fn new(detections: &[Detection], truth: &BoxPx, counted: &[usize], least: Thresholds) -> PhotoOutcome {
        let hit_confidence = least.confidence;
        let on_model = || detections.iter().filter(|d| d.box_px.iou(truth) >= least.iou);
        let confidence = on_model()
            .filter(|d| counted.contains(&d.label))
            .map(|d| d.score)
            .fold(0.0, f64::max);
        let other = on_model()
            .filter(|d| !counted.contains(&d.label) && d.score >= hit_confidence)
            .max_by(|a, b| a.score.total_cmp(&b.score))
            .map(|d| (d.label, d.score));
        let is_hit = confidence >= hit_confidence;
        let verdict = match other {
            _ if !is_hit => Verdict::Missed,
            Some(_) => Verdict::FoundWithOther,
            None => Verdict::Found,
        };
        let counts = |d: &&Detection| counted.contains(&d.label) && d.score >= hit_confidence;
        let strong = || detections.iter().filter(counts);
        PhotoOutcome {
            confidence,
            other,
            verdict,
            hallucinations: strong().filter(|d| d.box_px.iou(truth) < least.iou).count(),
            false_positives: strong().count() - usize::from(is_hit),
        }
    }

    pub(crate) fn of_each(
        detectors: &[EvaluatedDetector],
        found: &[Vec<Detection>],
        truth: &BoxPx,
        least: Thresholds,
    ) -> Vec<PhotoOutcome> {
        let both = detectors.iter().zip(found);
        both.map(|(detector, found)| PhotoOutcome::new(found, truth, &detector.counted, least))
            .collect()
    }

    /// Returns true if the model was found as its class, whatever else lies on it.
    pub fn is_hit(&self) -> bool {
        self.verdict != Verdict::Missed
    }

    /// Returns true if the model was found as something else only.
    pub fn is_misclassified(&self) -> bool {
        !self.is_hit() && self.other.is_some()
    }

    /// Returns true if nothing at all was found where the model is.
    pub fn has_disappeared(&self) -> bool {
        !self.is_hit() && self.other.is_none()
    }
}
