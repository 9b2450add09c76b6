//! Boxes.

use proptest::prelude::*;
use scaleproof_core::geometry::BoxPx;

#[test]
fn half_overlap_is_a_third() {
    let a = BoxPx::new(0.0, 0.0, 2.0, 1.0);
    let b = BoxPx::new(1.0, 0.0, 3.0, 1.0);
    assert!((a.iou(&b) - 1.0 / 3.0).abs() < 1e-15);
}

#[test]
fn empty_boxes_overlap_nothing() {
    let empty = BoxPx::new(5.0, 5.0, 5.0, 5.0);
    assert_eq!(empty.iou(&empty), 0.0);
    assert!(!empty.is_solid());
    assert!(!BoxPx::new(f64::NAN, 0.0, 1.0, 1.0).is_solid());
}

fn boxes() -> impl Strategy<Value = BoxPx> {
    (0.0..500.0_f64, 0.0..500.0_f64, 1.0..300.0_f64, 1.0..300.0_f64)
        .prop_map(|(x, y, w, h)| BoxPx::new(x, y, x + w, y + h))
}

proptest! {
    #[test]
    fn iou_is_symmetric_and_bounded(a in boxes(), b in boxes()) {
        prop_assert_eq!(a.iou(&b), b.iou(&a));
        prop_assert!((0.0..=1.0 + 1e-12).contains(&a.iou(&b)));
        prop_assert!((a.iou(&a) - 1.0).abs() < 1e-12);
    }
}
