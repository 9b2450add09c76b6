//! Networks that list their boxes, already suppressed: n labels, n boxes, n scores.

use super::anchor::{Anchor, from_corners};
use super::error::{misfit, strange_label};
use super::tensor::{Data, Tensor};
use crate::SCORE_FLOOR;
use crate::nms::CandidateBox;
use scaleproof_core::geometry::BoxPx;
use scaleproof_core::message::Message;

pub(super) struct Rows<'a> {
    labels: Vec<i64>,
    /// Four numbers a row, which each head reads in its own way.
    boxes: &'a [[f32; 4]],
    scores: &'a [f32],
    output: usize,
}

/// Names that TensorFlow's Object Detection API gives boxes, labels, scores and their number.
pub(crate) const TENSORFLOW: [&str; 4] = [
    "detection_boxes",
    "detection_classes",
    "detection_scores",
    "num_detections",
];

impl<'a> Rows<'a> {
    /// Picks the lists by type and size, in whatever order they come: whole-number labels n, boxes n×4, scores n. Other
    /// outputs (masks) are passed over.
    pub(super) fn pick(outputs: &'a [Tensor], kind: &str, expected: &str) -> Result<Rows<'a>, Message> {
        let find = || {
            let labels = outputs.iter().find_map(|t| match &t.data {
                Data::I64(v) => Some(v.clone()),
                Data::F32(_) => None,
            })?;
            let is_boxes = |t: &Tensor| t.shape.len() >= 2 && t.shape.last() == Some(&4);
            let of_length = |t: &'a Tensor, n: usize| t.floats().filter(|v| v.len() == n);
            let mut all = outputs.iter().enumerate();
            let is_found = |(_, t): &(usize, &'a Tensor)| is_boxes(t) && of_length(t, 4 * labels.len()).is_some();
            let (at, boxes) = all.find(is_found)?;
            let mut others = outputs.iter().enumerate().filter(|(i, _)| *i != at);
            let (output, scores) = others.find_map(|(i, t)| Some((i, of_length(t, labels.len())?)))?;
            Some(Rows {
                boxes: boxes.floats()?.as_chunks().0,
                labels,
                scores,
                output,
            })
        };
        find().ok_or_else(|| misfit(kind, expected.to_owned(), outputs))
    }

    /// Picks the lists of the TensorFlow Object Detection API by name, as classes and scores are alike in type and size; converters append
    /// `:0`. `named`: other names of the same four.
    pub(super) fn of_tensorflow(outputs: &'a [Tensor], named: Option<&[String; 4]>) -> Result<Rows<'a>, Message> {
        let names = named.map_or(TENSORFLOW, |named| named.each_ref().map(String::as_str));
        let position = |which: usize| {
            let called = outputs.iter().position(|t| t.name == names[which]);
            called.or_else(|| {
                outputs
                    .iter()
                    .position(|t| t.name.split(':').next() == Some(names[which]))
            })
        };
        let find = || {
            let mut labels = whole(&outputs[position(1)?]);
            let output = position(2)?;
            let boxes = outputs[position(0)?].floats()?;
            let scores = outputs[output].floats()?;
            if scores.len() != labels.len() || boxes.len() != 4 * labels.len() {
                return None;
            }
            let count = position(3).and_then(|i| whole(&outputs[i]).first().copied());
            labels.truncate(count.and_then(|n| usize::try_from(n).ok()).unwrap_or(usize::MAX));
            Some(Rows {
                labels,
                boxes: boxes.as_chunks().0,
                scores,
                output,
            })
        };
        let expected = format!("{} 1×n×4, {} 1×n, {} 1×n", names[0], names[1], names[2]);
        find().ok_or_else(|| misfit("tf_od", expected, outputs))
    }

    /// Every row whose label is known; those of padding have any label.
    pub(super) fn anchors(&self, labels: usize) -> Vec<Anchor> {
        let rows = self.labels.iter().zip(self.boxes).enumerate();
        let known = rows.filter_map(|(i, (label, b))| {
            let label = usize::try_from(*label).ok().filter(|label| *label < labels)?;
            Some(Anchor {
                label: Some(label),
                ..Anchor::new(b.map(f64::from).into(), self.output, None, i, 1)
            })
        });
        known.collect()
    }

    /// The candidates; `first_label` is the number of the list's first entry. A label outside the list is an error, since
    /// then the others are most likely other things than they are called, too.
    pub(super) fn candidates(
        &self,
        first_label: i64,
        labels: usize,
        to_input_px: impl Fn([f64; 4]) -> BoxPx,
    ) -> Result<Vec<CandidateBox>, Message> {
        let rows = self.labels.iter().zip(self.boxes).zip(self.scores);
        // Rows of padding have any label, and no score.
        let rows = rows.filter(|(_, score)| f64::from(**score) >= SCORE_FLOOR);
        let candidates = rows.map(|((label, b), score)| {
            let in_list = label.checked_sub(first_label).and_then(|l| usize::try_from(l).ok());
            match in_list.filter(|l| *l < labels) {
                Some(in_list) => Ok(from_corners(in_list, *score, to_input_px(b.map(f64::from)))),
                None => Err(strange_label(*label, labels)),
            }
        });
        candidates.filter_map(Result::transpose).collect()
    }
}

/// Whole numbers, which TensorFlow's API writes as floats. A NaN is no label; -1 is in no list.
fn whole(t: &Tensor) -> Vec<i64> {
    match &t.data {
        Data::I64(v) => v.clone(),
        Data::F32(v) => v
            .iter()
            .map(|v| if v.is_finite() { v.round() as i64 } else { -1 })
            .collect(),
    }
}
