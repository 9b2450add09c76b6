//! Boxes with the places of their scores in the outputs, and candidates made of them.

use super::tensor::Tensor;
use crate::SCORE_FLOOR;
use crate::manifest::AnchorLabels;
use crate::nms::CandidateBox;
use scaleproof_core::geometry::BoxPx;

/// A box, and where in the outputs its scores lie.
#[derive(Debug, Clone, PartialEq)]
pub struct Anchor {
    /// In input pixels; not always solid.
    pub b: BoxPx,
    pub output: usize,
    /// Index of its objectness, in heads that have one.
    pub objectness: Option<usize>,
    /// Index of its first label's score, or of its only one.
    pub first_label: usize,
    /// The only label it has a score for, in heads that name it.
    pub label: Option<usize>,
    /// Step from one label's score to the next.
    pub label_step: usize,
}

/// All boxes of a head that leaves the choice among them to its user.
pub struct Anchors {
    pub anchors: Vec<Anchor>,
    /// score = objectness^exponents\[0\] · label^exponents\[1\]
    pub exponents: [f32; 2],
    /// True where both are the sigmoids of the outputs' numbers.
    pub are_logits: bool,
    /// The label that the first score is of: 1 where the list begins with the background and the outputs do not.
    pub first_scored: usize,
    /// True where each label of an anchor that reaches the score floor is a detection, or the best alone.
    pub keeps: AnchorLabels,
}

impl Anchor {
    pub(super) fn new(
        b: BoxPx,
        output: usize,
        objectness: Option<usize>,
        first_label: usize,
        label_step: usize,
    ) -> Anchor {
        Anchor {
            b,
            output,
            objectness,
            first_label,
            label: None,
            label_step,
        }
    }
}

impl Anchors {
    pub(super) fn new(anchors: Vec<Anchor>) -> Anchors {
        Anchors {
            anchors,
            exponents: [1.0, 1.0],
            are_logits: false,
            first_scored: 0,
            keeps: AnchorLabels::Best,
        }
    }

    /// The label of an anchor that scores best, of so many, and its number in the output.
    pub fn best_label(&self, anchor: &Anchor, output: &[f32], labels: usize) -> (usize, f32) {
        let scores = output[anchor.first_label..]
            .iter()
            .step_by(anchor.label_step)
            .take(labels - self.first_scored);
        let (nth, best) = best(scores.copied());
        (nth + self.first_scored, best)
    }

    /// The labels of each anchor that are kept and reach the score floor.
    pub(super) fn candidates(&self, outputs: &[Tensor], labels: usize) -> Vec<CandidateBox> {
        let score = |number: f32| if self.are_logits { sigmoid(number) } else { number };
        let power = |score: f32, exponent: f32| if exponent == 1.0 { score } else { score.powf(exponent) };
        let mut found = Vec::new();
        for anchor in &self.anchors {
            let Some(data) = outputs.get(anchor.output).and_then(Tensor::floats) else {
                continue;
            };
            let objectness = anchor
                .objectness
                .map_or(1.0, |i| power(score(data[i]), self.exponents[0]));
            let candidate = |label: usize, number: f32| {
                from_corners(label, objectness * power(score(number), self.exponents[1]), anchor.b)
            };
            match self.keeps {
                AnchorLabels::Best => {
                    let (label, number) = self.best_label(anchor, data, labels);
                    found.extend(candidate(label, number));
                }
                // Most anchors see nothing, and no label of theirs can reach the floor.
                AnchorLabels::All if f64::from(objectness) < SCORE_FLOOR => {}
                AnchorLabels::All => {
                    let numbers = data[anchor.first_label..].iter().step_by(anchor.label_step);
                    let labelled = (self.first_scored..labels).zip(numbers);
                    found.extend(labelled.filter_map(|(label, number)| candidate(label, *number)));
                }
            }
        }
        found
    }
}

pub(super) fn is_finite(b: &BoxPx) -> bool {
    <[f64; 4]>::from(*b).iter().all(|v| v.is_finite())
}

pub(super) fn scaled(b: BoxPx, [width, height]: [u32; 2]) -> BoxPx {
    let (w, h) = (f64::from(width), f64::from(height));
    BoxPx::new(b.x1 * w, b.y1 * h, b.x2 * w, b.y2 * h)
}

pub(super) fn centred([cx, cy, w, h]: [f32; 4]) -> BoxPx {
    let [cx, cy, w, h] = [cx, cy, w, h].map(f64::from);
    BoxPx::new(cx - w / 2.0, cy - h / 2.0, cx + w / 2.0, cy + h / 2.0)
}

/// A candidate; `None` below the score floor and for a box without an area. A box that is not finite stays: [`super::candidates`] refuses the
/// whole answer, since dropping it would make a network that fails look like one that finds nothing.
pub(super) fn from_corners(label: usize, score: f32, b: BoxPx) -> Option<CandidateBox> {
    let score = f64::from(score);
    (score >= SCORE_FLOOR && (b.is_solid() || !is_finite(&b))).then_some(CandidateBox { label, score, b })
}

/// The best label and its score; the first of equals. NaN scores never win.
pub(super) fn best(scores: impl Iterator<Item = f32>) -> (usize, f32) {
    let first = (0, f32::NEG_INFINITY);
    let better = |best: (usize, f32), (i, s)| if s > best.1 { (i, s) } else { best };
    scores.enumerate().fold(first, better)
}

pub(super) fn sigmoid(x: f32) -> f32 {
    1.0 / (1.0 + (-x).exp())
}
