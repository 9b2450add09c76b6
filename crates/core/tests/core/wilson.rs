//! Intervals of rates.

use scaleproof_core::statistics::wilson_95;

#[test]
fn eight_of_eight_still_leaves_doubt() {
    let (low, high) = wilson_95(8, 8).unwrap();
    assert!((low - 0.676).abs() < 1e-3 && (high - 1.0).abs() < 1e-12);
    let (low, high) = wilson_95(0, 8).unwrap();
    assert!(low.abs() < 1e-12 && (high - 0.324).abs() < 1e-3);
    assert_eq!(wilson_95(0, 0), None);
}
