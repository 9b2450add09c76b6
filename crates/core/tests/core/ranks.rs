//! Agreement of orders.

use scaleproof_core::statistics::kendall_tau_b;

#[test]
fn by_hand() {
    let tau = |a: &[f64], b: &[f64]| kendall_tau_b(a, b, 1e-12).unwrap();
    assert_eq!(tau(&[1.0, 2.0, 3.0], &[10.0, 20.0, 30.0]), 1.0);
    assert_eq!(tau(&[1.0, 2.0, 3.0], &[3.0, 2.0, 1.0]), -1.0);
    // One of three pairs the other way round: (2 − 1) / 3.
    assert!((tau(&[1.0, 2.0, 3.0], &[1.0, 3.0, 2.0]) - 1.0 / 3.0).abs() < 1e-12);
    // One tie in the first list: 5 agreeing of √(5 · 6).
    assert!((tau(&[1.0, 2.0, 2.0, 4.0], &[1.0, 2.0, 3.0, 4.0]) - 5.0 / 30_f64.sqrt()).abs() < 1e-12);
    assert_eq!(kendall_tau_b(&[1.0, 1.0], &[1.0, 2.0], 1e-12), None);
}
