use scaleproof_score::Reliability;
use scaleproof_score::figures::reliability::deviation;

#[test]
fn four_detections_by_hand() {
    let r = Reliability::new("d".into(), &[(0.9, true), (1.0, true), (0.3, false), (0.34, true)]);
    let bin = |low: f64| r.bins.iter().find(|b| b.low == low).unwrap();
    assert_eq!((r.bins.len(), bin(0.9).detections, bin(0.3).detections), (9, 2, 2));
    assert!((bin(0.3).mean_confidence.unwrap() - 0.32).abs() < 1e-12);
    assert_eq!(bin(0.3).correct.unwrap().count, 1);
    // (2 · |0.95 − 1| + 2 · |0.32 − 0.5|) / 4
    assert!((r.expected_calibration_error.unwrap() - 0.115).abs() < 1e-12);
    assert_eq!(Reliability::new("d".into(), &[]).expected_calibration_error, None);
}

#[test]
fn the_error_by_chance_is_the_mean_of_the_binomial_s_deviations() {
    for (n, p) in [(1_i32, 0.3_f64), (2, 0.5), (5, 0.87), (12, 0.25), (40, 0.6)] {
        let mut chance = (1.0 - p).powi(n); // of k successes, from k = 0 on
        let mut sum = 0.0;
        for k in 0..=n {
            sum += chance * (f64::from(k) / f64::from(n) - p).abs();
            chance *= f64::from(n - k) / f64::from(k + 1) * p / (1.0 - p);
        }
        assert!((deviation(n as usize, p) - sum).abs() < 1e-12, "{n} {p}");
    }
}
