//! What the numbers mean: the choices of a run, and the definitions that stand beside its figures.

use super::{ApDefinition, HIT_CONFIDENCE, MATCH_IOU, Protocol, Thresholds};

/// The choices a figure depends on; stated wherever the figures are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Criteria {
    /// The definition of average precision.
    pub ap: ApDefinition,
    /// A detection this confident counts as one; in [0.001, 1].
    pub hit_confidence: f64,
    /// Whose protocol is followed, if any.
    pub protocol: Option<Protocol>,
}

impl Default for Criteria {
    /// COCO's 101-point AP, hits from confidence 0.5 up.
    fn default() -> Criteria {
        Criteria {
            ap: ApDefinition::default(),
            hit_confidence: HIT_CONFIDENCE,
            protocol: None,
        }
    }
}

impl Criteria {
    /// As a protocol has them.
    pub fn of(protocol: Protocol) -> Criteria {
        Criteria {
            ap: protocol.ap(),
            hit_confidence: protocol.hit_confidence(),
            protocol: Some(protocol),
        }
    }

    /// From which overlap with the truth box a detection is on the model; AP and reliability take 0.5 whatever it is.
    pub fn match_iou(&self) -> f64 {
        self.protocol.map_or(MATCH_IOU, Protocol::match_iou)
    }

    /// `≥`, or `>` where the protocol says so: what stands before a threshold.
    pub(crate) fn sign(&self) -> &'static str {
        match self.protocol.is_some_and(Protocol::is_strict) {
            true => ">",
            false => "≥",
        }
    }

    pub(super) fn thresholds(&self) -> Thresholds {
        let least = |threshold: f64| match self.protocol.is_some_and(Protocol::is_strict) {
            true => threshold.next_up(),
            false => threshold,
        };
        Thresholds {
            confidence: least(self.hit_confidence),
            iou: least(self.match_iou()),
        }
    }

    /// What each number means under these choices: (name, definition).
    pub fn definitions(&self) -> Vec<(&'static str, String)> {
        let (sign, iou) = (self.sign(), self.match_iou());
        let confidence = format!("confidence {sign} {}", self.hit_confidence);
        let on_model = format!("IoU {sign} {iou} with the truth box");
        let mut definitions = vec![
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
                    "share of photos with a detection of the model's class at {confidence} and {on_model}"
                ),
            ),
            (
                "misclassification rate",
                format!(
                    "share of photos without a hit but with a detection of another class at {confidence} and {on_model}"
                ),
            ),
            (
                "disappearance rate",
                format!(
                    "share of photos without any detection, whatever its class, at {confidence} and {on_model}; hits, misclassifications and \
                     disappearances add up to all photos"
                ),
            ),
            (
                "hallucinations per image",
                format!(
                    "mean number of detections of the model's class at {confidence} and a smaller IoU with the truth box; a second box on the \
                     model is none, and a real object of that class in the background is one, as nothing else is known to be there"
                ),
            ),
            (
                "false positives per image",
                format!(
                    "FPPI: mean number of detections of the model's class at {confidence} that are not the one which finds the model: \
                     hallucinations and second boxes"
                ),
            ),
            (
                "AP@[.5:.95]",
                format!("mean of AP over the ten IoU thresholds 0.5, 0.55, …, 0.95, definition {}", self.ap.name()),
            ),
            (
                "mAR",
                "recall reached with at most 100 detections a photo from confidence 0.001 up, mean over the same ten IoU thresholds; mAR 50 is \
                 that at IoU 0.5"
                    .to_owned(),
            ),
            (
                "attack success rate",
                "ASR: 1 − the figure of this variant ÷ the figure of the base, for AP@0.5 and for the hit rate; below 0 when the variant is found \
                 more often; none where the base's figure is 0"
                    .to_owned(),
            ),
            (
                "found from a confidence",
                "share of photos with a detection of the model's class on the model, for each confidence that may be asked for".to_owned(),
            ),
            (
                "95 % interval",
                "Wilson score interval of a rate; it treats photos as independent".to_owned(),
            ),
            (
                "confidence",
                "mean or median over photos of the highest confidence among detections of the model's class at IoU ≥ 0.5, whatever it is; \
                 a photo without one counts 0"
                    .replace("IoU ≥ 0.5", &format!("IoU {sign} {iou}")),
            ),
            (
                "drop",
                "the figure of the base variant, “normal” unless another is named, minus the figure of this variant, same detector and same group of photos".to_owned(),
            ),
        ];
        if let Some(protocol) = self.protocol {
            definitions.push(("protocol", format!("{}: {}", protocol.name(), protocol.source())));
        }
        definitions
    }
}
