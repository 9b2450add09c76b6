//! What one detector made of one photo.

use serde::Serialize;

use super::EvaluatedDetector;
use scaleproof_core::geometry::BoxPx;
use scaleproof_detect::Detection;

/// The colours of the borders that the paper draws around photos, the worst first.
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

/// From where on a detection counts.
#[derive(Debug, Clone, Copy)]
pub struct Thresholds {
    pub confidence: f64,
    /// Overlap with the truth box.
    pub iou: f64,
}

impl PhotoOutcome {
    /// Judges the detections of a photo against the model's truth box and the labels that count as it; those of too little confidence only lend
    /// the photo theirs.
    pub fn of(detections: &[Detection], truth: &BoxPx, counted: &[usize], least: Thresholds) -> PhotoOutcome {
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

    /// What each detector made of a photo.
    pub(super) fn of_each(
        detectors: &[EvaluatedDetector],
        found: &[Vec<Detection>],
        truth: &BoxPx,
        least: Thresholds,
    ) -> Vec<PhotoOutcome> {
        let both = detectors.iter().zip(found);
        both.map(|(detector, found)| PhotoOutcome::of(found, truth, &detector.counted, least))
            .collect()
    }

    /// True when the model was found as its class, whatever else lies on it.
    pub fn is_hit(&self) -> bool {
        self.verdict != Verdict::Missed
    }

    /// True when the model was found as something else only.
    pub fn is_misclassified(&self) -> bool {
        !self.is_hit() && self.other.is_some()
    }

    /// True when nothing at all was found where the model is.
    pub fn has_disappeared(&self) -> bool {
        !self.is_hit() && self.other.is_none()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CAR: usize = 2;
    const TRUCK: usize = 7;
    const LEAST: Thresholds = Thresholds {
        confidence: 0.5,
        iou: 0.5,
    };

    fn outcome(detections: &[(usize, f64, f64)]) -> PhotoOutcome {
        let detections: Vec<_> = detections
            .iter()
            .map(|(label, score, x)| Detection::new(*label, *score, BoxPx::new(*x, 0.0, x + 100.0, 50.0)).unwrap())
            .collect();
        PhotoOutcome::of(&detections, &BoxPx::new(0.0, 0.0, 100.0, 50.0), &[CAR], LEAST)
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

    #[test]
    fn a_photo_is_a_hit_or_misclassified_or_the_model_has_disappeared() {
        for (detections, fate) in [
            (vec![(CAR, 0.8, 0.0)], [true, false, false]),
            (vec![(CAR, 0.8, 0.0), (TRUCK, 0.9, 0.0)], [true, false, false]),
            (vec![(CAR, 0.4, 0.0), (TRUCK, 0.6, 5.0)], [false, true, false]),
            (vec![(CAR, 0.4, 0.0), (TRUCK, 0.4, 5.0)], [false, false, true]),
            (vec![(TRUCK, 0.9, 60.0)], [false, false, true]),
            (vec![], [false, false, true]),
        ] {
            let o = outcome(&detections);
            assert_eq!(
                [o.is_hit(), o.is_misclassified(), o.has_disappeared()],
                fate,
                "{detections:?}"
            );
        }
    }

    #[test]
    fn boxes_of_the_class_elsewhere_are_hallucinations_and_doubles_are_not() {
        let o = outcome(&[
            (CAR, 0.9, 0.0),
            (CAR, 0.8, 3.0),  // a second box on the model
            (CAR, 0.7, 60.0), // IoU 0.25
            (CAR, 0.6, 500.0),
            (CAR, 0.4, 900.0),   // not confident enough
            (TRUCK, 0.9, 500.0), // perhaps a truck is there
        ]);
        assert_eq!((o.hallucinations, o.false_positives, o.is_hit()), (2, 3, true));
    }
}
