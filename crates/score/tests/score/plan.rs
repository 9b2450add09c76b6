use scaleproof_core::statistics::mcnemar_p;
use scaleproof_score::score::pairs_needed;

/// All hits against none: six pairs give p = 2 / 2⁶, five do not reach 0.05.
#[test]
fn a_certain_drop_needs_six_pairs() {
    assert_eq!(pairs_needed(1.0, 1.0, 0.8, 0.05), Ok(6));
    assert!(mcnemar_p(&[1; 6]) < 0.05 && mcnemar_p(&[1; 5]) > 0.05);
}
