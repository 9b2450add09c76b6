//! Non-maximum suppression.

use std::collections::BTreeMap;

use scaleproof_core::geometry::BoxPx;

/// A decoded box before suppression, in input pixels.
#[derive(Debug, Clone, PartialEq)]
pub struct CandidateBox {
    pub label: usize,
    pub score: f64,
    pub b: BoxPx,
}

/// At most this many candidates, the best first, take part in suppression, as in the reference programs of the YOLO line (`max_nms` in YOLOv5 and in
/// Ultralytics): where all lie apart, each is compared with every better one, and 100,000 take more than 20 s.
const MOST_SUPPRESSED: usize = 30_000;

/// Greedy suppression within each label: a box goes when a better one of its label overlaps it by more than `iou`. Best first.
pub fn suppress(candidates: Vec<CandidateBox>, iou: f64) -> Vec<CandidateBox> {
    BestFirst::new(candidates, Some(iou)).collect()
}

/// Candidates in falling order of their scores, without those that suppression drops. A caller that needs a few stops early, and the
/// rest is never compared.
pub(super) struct BestFirst {
    waiting: std::vec::IntoIter<CandidateBox>,
    /// The overlap above which a box goes; `None` keeps every box.
    iou: Option<f64>,
    /// The boxes that came already, by label.
    kept: BTreeMap<usize, Vec<BoxPx>>,
}

impl BestFirst {
    /// Equals stay in their order.
    pub(super) fn new(mut candidates: Vec<CandidateBox>, iou: Option<f64>) -> BestFirst {
        candidates.sort_by(|a, b| b.score.total_cmp(&a.score));
        if iou.is_some() {
            candidates.truncate(MOST_SUPPRESSED);
        }
        BestFirst {
            waiting: candidates.into_iter(),
            iou,
            kept: BTreeMap::new(),
        }
    }

    /// The highest score of those to come; nothing suppresses the best box.
    pub(super) fn highest_score(&self) -> Option<f64> {
        self.waiting.as_slice().first().map(|c| c.score)
    }
}

impl Iterator for BestFirst {
    type Item = CandidateBox;

    fn next(&mut self) -> Option<CandidateBox> {
        let BestFirst { waiting, iou, kept } = self;
        let Some(iou) = *iou else { return waiting.next() };
        waiting.find(|c| {
            let better = kept.entry(c.label).or_default();
            let is_kept = better.iter().all(|k| k.iou(&c.b) <= iou);
            if is_kept {
                better.push(c.b);
            }
            is_kept
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn only_the_same_label_suppresses() {
        let at = |label, score, x: f64| CandidateBox {
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

    /// Boxes side by side, of falling scores.
    fn apart(count: usize) -> Vec<CandidateBox> {
        let at = |i: usize| CandidateBox {
            label: 0,
            score: 1.0 / (i + 1) as f64,
            b: BoxPx::new(i as f64, 0.0, i as f64 + 0.5, 1.0),
        };
        (0..count).map(at).collect()
    }

    #[test]
    fn whoever_needs_a_few_boxes_pays_for_no_others() {
        let mut boxes = BestFirst::new(apart(10_000), Some(0.5));
        assert_eq!(boxes.highest_score(), Some(1.0));
        assert_eq!(boxes.by_ref().take(100).collect::<Vec<_>>(), apart(100));
        assert_eq!(boxes.kept[&0].len(), 100);
    }

    #[test]
    fn no_more_than_the_best_30_000_take_part() {
        // In a hundred labels, so that an unoptimised build is quick, too.
        let mut candidates = apart(40_000);
        for (i, c) in candidates.iter_mut().enumerate() {
            c.label = i % 100;
        }
        assert_eq!(suppress(candidates.clone(), 0.5), candidates[..30_000].to_vec());
        // Without suppression nothing is compared, and all come.
        assert_eq!(BestFirst::new(candidates, None).count(), 40_000);
    }

    /// Suppression as its definition says it: every box against every better one that was kept.
    fn by_definition(mut candidates: Vec<CandidateBox>, iou: f64) -> Vec<CandidateBox> {
        candidates.sort_by(|a, b| b.score.total_cmp(&a.score));
        let mut kept: Vec<CandidateBox> = Vec::new();
        for c in candidates {
            if kept.iter().all(|k| k.label != c.label || k.b.iou(&c.b) <= iou) {
                kept.push(c);
            }
        }
        kept
    }

    /// Crowded boxes of few labels, with equal scores among them.
    fn crowd() -> impl Strategy<Value = Vec<CandidateBox>> {
        let one = (
            0..3_usize,
            1..50_u8,
            0.0..60.0_f64,
            0.0..60.0_f64,
            0.0..40.0_f64,
            0.0..40.0_f64,
        );
        let candidate = one.prop_map(|(label, score, x, y, w, h)| CandidateBox {
            label,
            score: f64::from(score) / 50.0,
            b: BoxPx::new(x, y, x + w, y + h),
        });
        prop::collection::vec(candidate, 0..200)
    }

    proptest! {
        #[test]
        fn what_is_kept_is_what_the_definition_keeps(candidates in crowd(), iou in 0.0..=1.0_f64, count in 0..200_usize) {
            let expected = by_definition(candidates.clone(), iou);
            prop_assert_eq!(&suppress(candidates.clone(), iou), &expected);
            let first: Vec<CandidateBox> = BestFirst::new(candidates, Some(iou)).take(count).collect();
            prop_assert_eq!(&first[..], &expected[..count.min(expected.len())]);
        }
    }
}
