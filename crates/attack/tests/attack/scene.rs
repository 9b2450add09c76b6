use scaleproof_attack::evaluate::azimuth_step;

#[test]
fn bins_are_as_fine_as_the_azimuths() {
    assert_eq!(azimuth_step(&[0.0, 30.0, 60.0, 330.0]), 30.0);
    assert_eq!(azimuth_step(&[45.0, 200.0]), 180.0);
    assert_eq!(azimuth_step(&[90.0]), 360.0);
    assert_eq!(azimuth_step(&[0.0, 0.001]), 1.0);
}
