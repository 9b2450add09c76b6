use scaleproof_score::figures::grouping::whole_steps;

#[test]
fn a_number_at_the_border_of_a_group_is_the_first_of_the_next() {
    for (number, step, whole) in [
        (0.3, 0.1, 3.0),
        (0.6, 0.1, 6.0),
        (0.7, 0.1, 7.0),
        (0.299, 0.1, 2.0),
        (-0.3, 0.1, -3.0),
        (0.0, 0.1, 0.0),
        (299.0, 100.0, 2.0),
    ] {
        assert_eq!(whole_steps(number / step), whole, "{number} in steps of {step}");
    }
}
