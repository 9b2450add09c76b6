//! Non-maximum suppression.

use crate::geometry::BoxPx;

/// A decoded box before suppression, in input pixels.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Candidate {
    pub label: usize,
    pub score: f64,
    pub b: BoxPx,
}

/// Greedy suppression within each label: a box goes when a better one of its label overlaps it by more than `iou`. Best first.
pub(crate) fn suppress(candidates: Vec<Candidate>, iou: f64) -> Vec<Candidate> {
    let mut kept: Vec<Candidate> = Vec::new();
    for c in sorted(candidates) {
        if kept.iter().all(|k| k.label != c.label || k.b.iou(&c.b) <= iou) {
            kept.push(c);
        }
    }
    kept
}

/// Best first; equals stay in their order.
pub(super) fn sorted(mut candidates: Vec<Candidate>) -> Vec<Candidate> {
    candidates.sort_by(|a, b| b.score.total_cmp(&a.score));
    candidates
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_same_label_suppresses() {
        let at = |label, score, x: f64| Candidate {
            label,
            score,
            b: BoxPx::new(x, 0.0, x + 10.0, 10.0),
        };
        let kept = suppress(
            vec![at(0, 0.6, 1.0), at(0, 0.9, 0.0), at(1, 0.5, 0.0), at(0, 0.4, 20.0)],
            0.45,
        );
        assert_eq!(kept.iter().map(|k| k.score).collect::<Vec<_>>(), [0.9, 0.5, 0.4]);
    }
}
