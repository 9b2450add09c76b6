//! Reliability of a detector's confidences: detections by confidence, against the share that is correct.

use serde::Serialize;
use statrs::distribution::{Binomial, Discrete};

use crate::evaluated::EvaluatedDetector;
use crate::figures::{DetectorView, MATCH_IOU, Rate, ScoredPhoto};

/// Confidence below which detections are left out: there are up to a hundred a photo, nearly all wrong and known to be.
pub const RELIABILITY_FLOOR: f64 = 0.1;

/// Number of steps of confidence from 0 to 1; the first lies below the floor.
const STEPS: usize = 10;

/// Confidence against correctness of one detector, over all variants.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Reliability {
    pub detector: String,
    /// Steps of confidence from 0.1 up; those without a detection are there, too.
    pub bins: Vec<ConfidenceBin>,
    /// Detections in all bins.
    pub detections: usize,
    /// Mean over detections of |mean confidence − share correct| of their bin (Guo et al. 2017, equation 3); `null` without a detection.
    pub expected_calibration_error: Option<f64>,
    /// The calibration error that chance alone would give if every bin's confidence were true; `null` without a detection.
    pub error_by_chance: Option<f64>,
}

/// The detections of one step of confidence.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct ConfidenceBin {
    /// Lower end of the bin, included; the upper end `high` is excluded, except 1 in the last bin.
    pub low: f64,
    pub high: f64,
    pub detections: usize,
    /// Mean confidence of these detections; `null` without a detection.
    pub mean_confidence: Option<f64>,
    /// Share that is correct: the first of a photo that overlaps the truth box by IoU 0.5; `null` without a detection.
    pub correct: Option<Rate>,
}

/// Returns the reliability of every detector, in their order.
pub fn reliability(photos: &[ScoredPhoto], detectors: &[EvaluatedDetector]) -> Vec<Reliability> {
    let of = |(side, detector): (DetectorView, &EvaluatedDetector)| {
        let detections = photos.iter().flat_map(|p| judged(p, side));
        Reliability::new(detector.manifest.name.clone(), &detections.collect::<Vec<_>>())
    };
    DetectorView::each(detectors).map(of).collect()
}

/// Returns (confidence, correct) of the detections of the class in one photo. Correct is the first, in descending confidence, that overlaps the truth
/// enough; every further one is a double, and wrong, as for AP.
fn judged(photo: &ScoredPhoto, side: DetectorView) -> Vec<(f64, bool)> {
    let mut detections = side.boxes(photo).detections;
    detections.sort_by(|a, b| b.0.total_cmp(&a.0));
    let first = detections.iter().position(|(_, b)| b.iou(&photo.truth) >= MATCH_IOU);
    let numbered = detections.iter().enumerate();
    numbered
        .filter(|(_, (score, _))| *score >= RELIABILITY_FLOOR)
        .map(|(i, (score, _))| (*score, Some(i) == first))
        .collect()
}

impl Reliability {
    /// Computes the reliability of a detector, from (confidence, correct) of every detection.
    pub fn new(detector: String, detections: &[(f64, bool)]) -> Reliability {
        let bins: Vec<ConfidenceBin> = (1..STEPS).map(|step| bin(step, detections)).collect();
        // Mean over all bins, weighted by their numbers of detections.
        let mean = |off: fn(&ConfidenceBin) -> Option<f64>| {
            let weighted = bins.iter().filter_map(|b| Some(b.detections as f64 * off(b)?));
            (!detections.is_empty()).then(|| weighted.sum::<f64>() / detections.len() as f64)
        };
        Reliability {
            detector,
            detections: detections.len(),
            expected_calibration_error: mean(|b| Some((b.mean_confidence? - b.correct?.rate).abs())),
            error_by_chance: mean(|b| Some(deviation(b.detections, b.mean_confidence?))),
            bins,
        }
    }
}

fn bin(step: usize, detections: &[(f64, bool)]) -> ConfidenceBin {
    let step_of = |confidence: f64| ((confidence * STEPS as f64 + 1e-9) as usize).min(STEPS - 1);
    let own: Vec<_> = detections.iter().filter(|(c, _)| step_of(*c) == step).collect();
    let correct = own.iter().filter(|(_, correct)| *correct).count();
    let count = own.len() as f64;
    ConfidenceBin {
        low: step as f64 / STEPS as f64,
        high: (step + 1) as f64 / STEPS as f64,
        detections: own.len(),
        mean_confidence: (!own.is_empty()).then(|| own.iter().map(|(c, _)| c).sum::<f64>() / count),
        correct: Rate::new(correct, own.len()),
    }
}

/// Returns the mean distance of the share of successes in `n` trials from their probability `p`: 2 m C(n, m) pᵐ (1 − p)ⁿ⁻ᵐ⁺¹ / n with m = ⌊np⌋ + 1
/// (de Moivre 1730; Diaconis & Zabell 1991).
pub fn deviation(n: usize, p: f64) -> f64 {
    if n == 0 || p <= 0.0 || p >= 1.0 {
        return 0.0;
    }
    let m = (n as f64 * p).floor() + 1.0;
    let of_m = Binomial::new(p, n as u64).map_or(0.0, |b| b.pmf(m as u64));
    2.0 * m * (1.0 - p) * of_m / n as f64
}
