use scaleproof_score::score::Finding;
use scaleproof_score::score::compare::difference;

/// Sums that differ by their order of addition alone are the same; one that is the same in all resamples is shown.
#[test]
fn a_difference_without_an_interval_is_none_or_shown() {
    let rounded = difference(14, |_| (0.1 + 0.2, 0.3));
    assert!(rounded.drop != 0.0);
    assert_eq!(rounded.finding, Finding::NoDifferenceShown);
    assert_eq!(difference(14, |_| (1.0, 0.0)).finding, Finding::Drop);
    assert_eq!(difference(6, |_| (0.0, 1.0)).finding, Finding::Rise);
    assert_eq!(difference(5, |_| (1.0, 0.0)).finding, Finding::TooFewPhotosToTell);
}
