use scaleproof_attack::run::weights::{Against, DetectorWeights, TEMPERATURE};

#[test]
fn the_detector_that_sees_the_model_best_counts_most() {
    let mut weights = DetectorWeights::new(3);
    assert_eq!(weights.weights(Against::Worst), [1.0; 3]);
    weights.observe(&[2.0, 6.0, 2.0]);
    assert_eq!(weights.weights(Against::Mean), [1.0; 3]);
    let [a, b, c] = weights.weights(Against::Worst)[..] else {
        panic!()
    };
    assert!(a == c && (b / a - (4.0_f64 / TEMPERATURE).exp()).abs() < 1e-12);
    assert!((a + b + c - 3.0).abs() < 1e-12);
    // What a detector said long ago is forgotten.
    (0..100).for_each(|_| weights.observe(&[6.0, 2.0, 2.0]));
    assert!(weights.weights(Against::Worst)[0] > weights.weights(Against::Worst)[1]);
}
