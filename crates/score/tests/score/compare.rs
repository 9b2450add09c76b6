use scaleproof_score::compare::difference;

/// Sums that differ by their order of addition alone are the same, and have no interval; nor has a difference that is the same in all resamples.
#[test]
fn a_difference_without_an_interval_is_the_same_in_all_resamples() {
    let rounded = difference(14, |_| (0.1 + 0.2, 0.3));
    assert!(rounded.drop != 0.0 && rounded.drop.abs() < 1e-9);
    assert_eq!(rounded.interval_95, None);
    assert_eq!(difference(14, |_| (1.0, 0.0)).interval_95, None);
    assert_eq!(difference(5, |_| (1.0, 0.0)).interval_95, None);
}
