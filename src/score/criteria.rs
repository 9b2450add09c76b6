//! What the numbers mean: the choices of a run, and the definitions that stand beside its figures.

use super::{ApDefinition, HIT_CONFIDENCE};

/// The choices a figure depends on; stated wherever the figures are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Criteria {
    /// The definition of average precision.
    pub ap: ApDefinition,
    /// A detection this confident counts as one; in [0.001, 1].
    pub hit_confidence: f64,
}

impl Default for Criteria {
    /// COCO's 101-point AP, hits from confidence 0.5 up.
    fn default() -> Criteria {
        Criteria {
            ap: ApDefinition::default(),
            hit_confidence: HIT_CONFIDENCE,
        }
    }
}

impl Criteria {
    /// What each number means under these choices: (name, definition).
    pub fn definitions(&self) -> Vec<(&'static str, String)> {
        let confidence = self.hit_confidence;
        vec![
            (
                "AP@0.5",
                format!(
                    "average precision of the model's class at IoU ≥ 0.5, definition {} ({}); matching as COCO does it, at most 100 \
                     detections a photo, candidates from confidence 0.001 up",
                    self.ap.name(),
                    self.ap.meaning()
                ),
            ),
            (
                "hit rate",
                format!(
                    "share of photos with a detection of the model's class at confidence ≥ {confidence} and IoU ≥ 0.5 with the truth box"
                ),
            ),
            (
                "misclassification rate",
                format!(
                    "share of photos without a hit but with a detection of another class at confidence ≥ {confidence} and IoU ≥ 0.5 with the \
                     truth box"
                ),
            ),
            (
                "disappearance rate",
                format!(
                    "share of photos without any detection, whatever its class, at confidence ≥ {confidence} and IoU ≥ 0.5 with the truth \
                     box; hits, misclassifications and disappearances add up to all photos"
                ),
            ),
            (
                "hallucinations per image",
                format!(
                    "mean number of detections of the model's class at confidence ≥ {confidence} and IoU < 0.5 with the truth box; a second \
                     box on the model is none, and a real object of that class in the background is one, as nothing else is known to be there"
                ),
            ),
            (
                "95 % interval",
                "Wilson score interval of a rate; it treats photos as independent".to_owned(),
            ),
            (
                "confidence",
                "mean or median over photos of the highest confidence among detections of the model's class at IoU ≥ 0.5, whatever it is; \
                 a photo without one counts 0"
                    .to_owned(),
            ),
            (
                "drop",
                "the figure of the variant “normal” minus the figure of this variant, same detector and same group of photos".to_owned(),
            ),
        ]
    }
}
