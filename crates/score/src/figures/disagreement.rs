//! Sentences on AP and hit rate that disagree: AP ranks weak detections too, a hit must be confident.

use crate::figures::{DetectorView, MATCH_IOU, ScoredPhoto, Scores, Summary};
use scaleproof_core::ap::{ApDefinition, average_precision_as};
use scaleproof_core::spelling::digits;
use scaleproof_detect::Detection;

/// Difference between AP and hit rate from which it is explained.
const TELLING: f64 = 0.3;

/// Returns a sentence for each detector and variant whose AP and hit rate disagree.
pub fn disagreements(scores: &Scores) -> Vec<String> {
    scores.summaries.iter().filter_map(|s| explained(scores, s)).collect()
}

fn explained(scores: &Scores, s: &Summary) -> Option<String> {
    let side = DetectorView::named(&scores.detectors, &s.detector)?;
    let f = &s.overall;
    let difference = f.ap50 - f.hit_rate.rate;
    if difference.abs() < TELLING {
        return None;
    }
    let own = VariantPhotos {
        scores,
        side,
        photos: scores.photos.iter().filter(|p| p.variant == s.variant).collect(),
    };
    let causes = if difference > 0.0 {
        [own.by_ramp(f.ap50), own.weak()]
    } else {
        [own.by_overlap(), own.false_positives()]
    };
    let causes: Vec<String> = causes.into_iter().flatten().collect();
    let why = if causes.is_empty() {
        String::new()
    } else {
        format!(", since {}", causes.join(", and "))
    };
    Some(format!(
        "{} on “{}”: AP@0.5 is {} beside {} of {} photos hit{why}",
        scores.title(&s.detector),
        s.variant,
        digits(f.ap50, 2),
        f.hit_rate.count,
        f.photos
    ))
}

/// The photos of one variant, as one detector saw them.
struct VariantPhotos<'a> {
    scores: &'a Scores,
    side: DetectorView<'a>,
    photos: Vec<&'a ScoredPhoto>,
}

impl VariantPhotos<'_> {
    /// Returns the part of YOLOv5's definition in the difference: it joins the last recall reached to recall 1 by a ramp, whose area counts.
    fn by_ramp(&self, ap50: f64) -> Option<String> {
        let is_ramp = self.scores.criteria.ap == ApDefinition::Yolov5Ramp;
        let images = is_ramp.then(|| self.side.images(self.photos.iter().copied()))?;
        let without = average_precision_as(ApDefinition::Coco101, &images, MATCH_IOU)?.ap;
        (ap50 - without >= TELLING / 2.0).then(|| {
            format!(
                "YOLOv5's definition counts recalls that are not reached (COCO's gives {})",
                digits(without, 2)
            )
        })
    }

    /// Returns the part of detections too weak for a hit.
    fn weak(&self) -> Option<String> {
        let outcomes = self.photos.iter().map(|p| self.side.outcome(p));
        let count = outcomes.filter(|o| o.confidence > 0.0 && !o.is_hit()).count();
        let least = self.scores.criteria.hit_confidence;
        (count > 0).then(|| {
            format!(
                "{count} more photos show the model at a confidence below {least}, which AP counts by rank and a hit does not"
            )
        })
    }

    /// Returns the part of hits of a protocol that requires less overlap than AP.
    fn by_overlap(&self) -> Option<String> {
        let (side, least) = (self.side, self.scores.criteria.thresholds());
        let is_loose = |p: &&&ScoredPhoto| {
            let is_close = |d: &Detection| {
                side.counted.contains(&d.label) && d.score >= least.confidence && d.box_px.iou(&p.truth) >= MATCH_IOU
            };
            self.side.outcome(p).is_hit() && !p.detections[side.detector].iter().any(is_close)
        };
        let count = self.photos.iter().filter(is_loose).count();
        (count > 0).then(|| {
            format!(
                "{count} of the hits overlap the truth box by less than {MATCH_IOU}, which is enough for a hit of this protocol and not for AP"
            )
        })
    }

    fn false_positives(&self) -> Option<String> {
        let wrong: usize = self.photos.iter().map(|p| self.side.outcome(p).false_positives).sum();
        let loose = self.scores.criteria.match_iou() < MATCH_IOU;
        (wrong > 0 || !loose).then(|| {
            format!(
                "AP counts false positives too: {wrong} from confidence {} up, and weaker ones",
                self.scores.criteria.hit_confidence
            )
        })
    }
}
