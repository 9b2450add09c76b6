//! Curves behind the figures: precision over recall, and the share of photos that show the model from each confidence up.

use serde::Serialize;

use crate::figures::{DetectorView, MATCH_IOU, Rate, Scores, Summary};
use scaleproof_core::ap::Ranked;

/// The curves of one detector on one variant, over all its photos.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Curves {
    pub detector: String,
    pub variant: String,
    /// Points where the precision changes its course, from the most confident detection on, at IoU 0.5.
    pub precision_recall: Vec<CurvePoint>,
    /// Share of photos that show the model at a confidence or more, from 0 to 1 in steps of 0.05.
    pub hit_rate: Vec<HitRateFrom>,
}

/// Precision and recall of the detections down to one.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
pub struct CurvePoint {
    pub recall: f64,
    pub precision: f64,
}

/// Share of photos that show the model at some confidence or more.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
pub struct HitRateFrom {
    pub confidence: f64,
    #[serde(flatten)]
    pub rate: Rate,
}

const STEPS: u32 = 20;

/// Returns the curves of every detector on every variant, in the order of the summaries.
pub fn curves(scores: &Scores) -> Vec<Curves> {
    scores.summaries.iter().filter_map(|s| curves_of(scores, s)).collect()
}

fn curves_of(scores: &Scores, s: &Summary) -> Option<Curves> {
    let side = DetectorView::named(&scores.detectors, &s.detector)?;
    let photos = || scores.photos.iter().filter(|p| p.variant == s.variant);
    let images = side.images(photos());
    let curve = Ranked::new(&images, MATCH_IOU).curve(|_| 1).unwrap_or_default();
    let found_from = |confidence: f64| {
        // A photo without any detection has confidence 0, and does not count from 0 up either.
        let finds = photos().filter(|p| side.outcome(p).confidence >= confidence.max(f64::MIN_POSITIVE));
        let rate = Rate::new(finds.count(), images.len())?;
        Some(HitRateFrom { confidence, rate })
    };
    let steps = (0..=STEPS).map(|step| f64::from(step) / f64::from(STEPS));
    Some(Curves {
        detector: s.detector.clone(),
        variant: s.variant.clone(),
        precision_recall: corners(&curve),
        hit_rate: steps.filter_map(found_from).collect(),
    })
}

/// Returns the points at which recall begins or ends to rise: between two of them precision only falls.
fn corners(curve: &[(f64, f64)]) -> Vec<CurvePoint> {
    let rises = |i: usize| i < curve.len() && curve[i].1 > i.checked_sub(1).map_or(0.0, |before| curve[before].1);
    let is_corner = |i: &usize| rises(*i) || rises(i + 1);
    let points = (0..curve.len()).filter(is_corner).map(|i| CurvePoint {
        recall: curve[i].1,
        precision: curve[i].0,
    });
    points.collect()
}
