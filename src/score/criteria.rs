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
        let (ap, confidence) = (self.ap, self.hit_confidence.to_string());
        let words = [
            ("{ap}", ap.name()),
            ("{meaning}", ap.meaning()),
            ("{confidence}", &confidence),
        ];
        let filled = |text: &str| {
            words
                .iter()
                .fold(text.to_owned(), |text, (word, said)| text.replace(word, said))
        };
        let all = include_str!("definitions.txt")
            .lines()
            .filter_map(|line| line.split_once(" | "));
        all.map(|(name, text)| (name, filled(text))).collect()
    }
}
