use scaleproof_attack::run::adam::CellMoments;

#[test]
fn it_finds_the_bottom_of_a_bowl_and_stops_at_the_clip() {
    let (bottom, mut cells) = ([0.3, 0.8, 1.7], vec![[0.5; 3]]);
    let mut adam = CellMoments::new(1);
    for _ in 0..2000 {
        let gradient = [std::array::from_fn(|c| 2.0 * (cells[0][c] - bottom[c]))];
        adam.step(&mut cells, &gradient, 0.01, [0.0, 1.0]);
    }
    for (found, wanted) in cells[0].iter().zip([0.3, 0.8, 1.0]) {
        assert!((found - wanted).abs() < 1e-3, "{found} {wanted}");
    }
}

#[test]
fn the_first_step_is_the_learning_rate_whatever_the_gradient() {
    let mut cells = vec![[0.5; 3]];
    CellMoments::new(1).step(&mut cells, &[[1e-3, -40.0, 0.0]], 0.02, [0.0, 1.0]);
    let [a, b, c] = cells[0];
    assert!((a - 0.48).abs() < 1e-4 && (b - 0.52).abs() < 1e-4 && c == 0.5);
}
