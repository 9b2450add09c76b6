//! What the networks have in common that list their boxes: n labels, n boxes, n scores, already suppressed.

use super::super::nms::CandidateBox;
use super::{Anchor, Data, HeadError, SCORE_FLOOR, Tensor, from_corners};
use scaleproof_core::geometry::BoxPx;

/// The three lists, of equal length.
pub(super) struct Rows<'a> {
    pub labels: Vec<i64>,
    /// Four numbers a row; what they mean is the head's business.
    pub boxes: &'a [f32],
    pub scores: &'a [f32],
}

impl<'a> Rows<'a> {
    /// Picks the lists by type and size, in whatever order they come: whole-number labels n, boxes n×4, scores n. Other
    /// outputs (masks) are passed over. `None` when they are not there.
    pub(super) fn pick(outputs: &'a [Tensor]) -> Option<Rows<'a>> {
        let labels = outputs.iter().find_map(|t| match &t.data {
            Data::I64(v) => Some(v.clone()),
            Data::F32(_) => None,
        })?;
        let boxes = outputs.iter().position(|t| {
            t.shape.len() >= 2 && t.shape.last() == Some(&4) && t.floats().is_some_and(|v| v.len() == 4 * labels.len())
        })?;
        let (_, scores) = outputs
            .iter()
            .enumerate()
            .filter(|(i, _)| *i != boxes)
            .filter_map(|(i, t)| Some((i, t.floats()?)))
            .find(|(_, v)| v.len() == labels.len())?;
        Some(Rows {
            labels,
            boxes: outputs[boxes].floats()?,
            scores,
        })
    }

    /// Every row whose label is known; those of padding have any label.
    pub(super) fn anchors(&self, outputs: &[Tensor], labels: usize) -> Vec<Anchor> {
        let of_scores = |t: &Tensor| t.floats().is_some_and(|v| std::ptr::eq(v, self.scores));
        let output = outputs.iter().position(of_scores).unwrap_or(0);
        let rows = self.labels.iter().zip(self.boxes.chunks_exact(4)).enumerate();
        let known = rows.filter_map(|(i, (label, b))| {
            let label = usize::try_from(*label).ok().filter(|label| *label < labels)?;
            let b = BoxPx::from([b[0], b[1], b[2], b[3]].map(f64::from));
            Some(Anchor {
                label: Some(label),
                ..Anchor::in_row(b, output, i, false)
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
    ) -> Result<Vec<CandidateBox>, HeadError> {
        let rows = self.labels.iter().zip(self.boxes.chunks_exact(4)).zip(self.scores);
        // Rows of padding have any label, and no score.
        let rows = rows.filter(|(_, score)| f64::from(**score) >= SCORE_FLOOR);
        let candidates = rows.map(|((label, b), score)| {
            let in_list = label.checked_sub(first_label).and_then(|l| usize::try_from(l).ok());
            let in_list = in_list
                .filter(|l| *l < labels)
                .ok_or_else(|| strange_label(*label, labels))?;
            Ok(from_corners(
                in_list,
                *score,
                to_input_px([b[0], b[1], b[2], b[3]].map(f64::from)),
            ))
        });
        let candidates: Result<Vec<_>, HeadError> = candidates.collect();
        Ok(candidates?.into_iter().flatten().collect())
    }
}

/// The refusal of a label that the manifest does not have.
pub(super) fn strange_label(label: impl std::fmt::Display, labels: usize) -> HeadError {
    let label = label.to_string();
    HeadError::StrangeLabel { label, labels }
}
