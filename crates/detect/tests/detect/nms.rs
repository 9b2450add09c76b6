//! Non-maximum suppression.

use scaleproof_core::geometry::BoxPx;
use scaleproof_detect::{BestFirst, CandidateBox, suppress};

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
