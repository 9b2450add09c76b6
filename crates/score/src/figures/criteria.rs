//! Criteria of a run, and the definitions that stand beside its figures.

use crate::figures::{HIT_CONFIDENCE, MATCH_IOU, Protocol, Thresholds};
use scaleproof_core::ap::ApDefinition;

/// The choices a figure depends on; stated wherever the figures are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Criteria {
    /// Definition of average precision.
    pub ap: ApDefinition,
    /// Confidence from which a detection counts as a hit, in [0.001, 1].
    pub hit_confidence: f64,
    /// Protocol that is followed, if any.
    pub protocol: Option<Protocol>,
}

impl Default for Criteria {
    /// Returns COCO's 101-point AP, and hits from confidence 0.5 up.
    fn default() -> Criteria {
        Criteria {
            ap: ApDefinition::default(),
            hit_confidence: HIT_CONFIDENCE,
            protocol: None,
        }
    }
}

impl Criteria {
    /// Returns the criteria of a protocol.
    pub fn of(protocol: Protocol) -> Criteria {
        Criteria {
            ap: protocol.ap(),
            hit_confidence: HIT_CONFIDENCE,
            protocol: Some(protocol),
        }
    }

    /// Returns the IoU with the truth box from which a detection is on the model; AP and reliability take 0.5 whatever it is.
    pub fn match_iou(&self) -> f64 {
        self.protocol.map_or(MATCH_IOU, Protocol::match_iou)
    }

    /// Returns the sign before a threshold: `≥`, or `>` where the protocol says so.
    pub fn sign(&self) -> &'static str {
        if self.protocol.is_some_and(Protocol::is_strict) {
            ">"
        } else {
            "≥"
        }
    }

    /// Returns the condition for a detection of the class to be a hit, in words.
    pub fn hit(&self) -> String {
        let (sign, confidence, iou) = (self.sign(), self.hit_confidence, self.match_iou());
        format!("confidence {sign} {confidence} and IoU {sign} {iou}")
    }

    pub(crate) fn thresholds(&self) -> Thresholds {
        let is_strict = self.protocol.is_some_and(Protocol::is_strict);
        let least = |threshold: f64| if is_strict { threshold.next_up() } else { threshold };
        Thresholds {
            confidence: least(self.hit_confidence),
            iou: least(self.match_iou()),
        }
    }

    /// Returns (name, definition) of each figure under these criteria.
    pub fn definitions(&self) -> Vec<(&'static str, String)> {
        let confidence = format!("confidence {} {}", self.sign(), self.hit_confidence);
        let overlap = format!("IoU {} {}", self.sign(), self.match_iou());
        let words = [
            ("{ap}", self.ap.name()),
            ("{meaning}", self.ap.meaning()),
            ("{confidence}", &confidence),
            ("{overlap}", &overlap),
        ];
        let words = words.iter();
        let filled = |text: &str| {
            words
                .clone()
                .fold(text.to_owned(), |text, (word, said)| text.replace(word, said))
        };
        let all = include_str!("definitions.txt").lines();
        let all = all.filter_map(|line| line.split_once(" | "));
        let said = |protocol: Protocol| format!("{}: {}", protocol.name(), protocol.source());
        let protocol = self.protocol.map(|protocol| ("protocol", said(protocol)));
        all.map(|(name, text)| (name, filled(text))).chain(protocol).collect()
    }
}
