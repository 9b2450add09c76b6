use scaleproof_score::report::words::numbers::number;
use scaleproof_score::report::words::numbers::p_value;

#[test]
fn only_what_is_below_zero_has_a_minus() {
    assert_eq!(
        [0.139, -0.25, -0.001, 0.0].map(|v| number(v, 2)),
        ["0.14", "−0.25", "0.00", "0.00"]
    );
}

/// A small p is not said to be zero, and one above the level not to be at it.
#[test]
fn no_p_is_rounded_to_what_it_is_not() {
    assert_eq!(
        [2.0 / 4096.0, 2.0 / 256.0, 0.0501, 0.05].map(p_value),
        ["< 0.001", "= 0.008", "> 0.050", "= 0.050"]
    );
}
