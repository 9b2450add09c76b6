//! Non-maximum suppression.

use std::collections::BTreeMap;

use scaleproof_core::geometry::BoxPx;

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

/// An iterator over candidates in falling order of their scores, without those that suppression drops. A caller that needs a few stops early,
/// and the rest is never compared.
pub struct BestFirst {
    waiting: std::vec::IntoIter<CandidateBox>,
    /// The overlap above which a box goes; `None` keeps every box.
    iou: Option<f64>,
    /// The boxes that came already, by label.
    pub kept: BTreeMap<usize, Vec<BoxPx>>,
}

impl BestFirst {
    /// Sorts the candidates; those of the same score stay in their order.
    pub fn new(mut candidates: Vec<CandidateBox>, iou: Option<f64>) -> BestFirst {
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
    pub fn highest_score(&self) -> Option<f64> {
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
