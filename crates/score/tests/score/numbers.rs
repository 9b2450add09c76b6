use scaleproof_score::report::html::number;

#[test]
fn only_what_is_below_zero_has_a_minus() {
    assert_eq!(
        [0.139, -0.25, -0.001, 0.0].map(|v| number(v, 2)),
        ["0.14", "−0.25", "0.00", "0.00"]
    );
}
