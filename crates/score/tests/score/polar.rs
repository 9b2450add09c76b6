use scaleproof_score::report::charts::polar::at;

#[test]
fn the_left_side_is_on_the_left() {
    let [x, y] = at(90.0, 1.0);
    assert!(x < -87.0 && y.abs() < 1e-9);
    assert!(at(0.0, 1.0)[1] < -87.0, "the front is up");
}
