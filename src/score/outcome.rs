//! What one detector made of one photo.

use serde::Serialize;

use super::{HIT_CONFIDENCE, MATCH_IOU};
use crate::detect::Detection;
use crate::geometry::BoxPx;

/// The paper's picture borders.
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

/// What one detector made of the model in one photo.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Highest confidence among detections of the class that overlap the truth enough; 0 for a miss.
    pub confidence: f64,
    /// The most confident other label on the model at hit confidence: (label, confidence).
    pub other: Option<(usize, f64)>,
    pub verdict: Verdict,
}

impl Outcome {
    /// Judges the detections of a photo against the model's truth box and class.
    pub fn of(detections: &[Detection], truth: &BoxPx, class: usize) -> Outcome {
        let on_model = || detections.iter().filter(|d| d.box_px.iou(truth) >= MATCH_IOU);
        let confidence = on_model()
            .filter(|d| d.label == class)
            .map(|d| d.score)
            .fold(0.0, f64::max);
        let other = on_model()
            .filter(|d| d.label != class && d.score >= HIT_CONFIDENCE)
            .max_by(|a, b| a.score.total_cmp(&b.score))
            .map(|d| (d.label, d.score));
        let verdict = match (confidence >= HIT_CONFIDENCE, other.is_some()) {
            (false, _) => Verdict::Missed,
            (true, true) => Verdict::FoundWithOther,
            (true, false) => Verdict::Found,
        };
        Outcome {
            confidence,
            other,
            verdict,
        }
    }

    /// True when the model was found as its class, whatever else lies on it.
    pub fn is_hit(&self) -> bool {
        self.verdict != Verdict::Missed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CAR: usize = 2;
    const TRUCK: usize = 7;

    fn outcome(detections: &[(usize, f64, f64)]) -> Outcome {
        let detections: Vec<_> = detections
            .iter()
            .map(|(label, score, x)| Detection::new(*label, *score, BoxPx::new(*x, 0.0, x + 100.0, 50.0)).unwrap())
            .collect();
        Outcome::of(&detections, &BoxPx::new(0.0, 0.0, 100.0, 50.0), CAR)
    }

    #[test]
    fn the_paper_s_borders() {
        assert_eq!(outcome(&[(CAR, 0.8, 0.0)]).verdict, Verdict::Found);
        assert_eq!(
            outcome(&[(CAR, 0.8, 0.0), (TRUCK, 0.6, 5.0)]).verdict,
            Verdict::FoundWithOther
        );
        assert_eq!(outcome(&[(CAR, 0.8, 0.0), (TRUCK, 0.4, 5.0)]).verdict, Verdict::Found);
        assert_eq!(outcome(&[(TRUCK, 0.9, 0.0)]).verdict, Verdict::Missed);
        assert_eq!(
            outcome(&[(CAR, 0.8, 60.0)]).verdict,
            Verdict::Missed,
            "another car beside the model"
        );
        assert_eq!(outcome(&[]).confidence, 0.0);
    }

    #[test]
    fn a_weak_find_keeps_its_confidence_but_is_a_miss() {
        let weak = outcome(&[(CAR, 0.3, 0.0), (CAR, 0.2, 1.0)]);
        assert_eq!((weak.confidence, weak.is_hit()), (0.3, false));
    }
}
