//! The probability of a bin.

use scaleproof_pose::locate::{Sigma, bin_probability};
use scaleproof_pose::scene::{Bins, Viewpoint};

fn bins() -> Bins {
    Bins {
        azimuth_deg: 45.0,
        pitch_deg: vec![0.0, 15.0, 30.0],
        distance_mm: vec![850.0],
    }
}

fn probability(azimuth_deg: f64, pitch_deg: f64, sigma_deg: f64) -> f64 {
    let v = Viewpoint {
        azimuth_deg,
        pitch_deg,
        distance_mm: 900.0,
    };
    let sigma = Sigma {
        azimuth_deg: sigma_deg,
        pitch_deg: sigma_deg,
        distance_mm: 5.0,
    };
    bin_probability(&bins().bin_of(&v), &bins(), &v, &sigma)
}

#[test]
fn on_an_edge_it_is_a_half_and_in_the_middle_one() {
    assert!((probability(22.5, 15.0, 0.1) - 0.5).abs() < 1e-9);
    assert!((probability(337.5, 15.0, 0.1) - 0.5).abs() < 1e-9);
    assert!((probability(359.9, 40.0, 0.1) - 1.0).abs() < 1e-9);
    assert!((probability(22.5, 7.5, 0.1) - 0.25).abs() < 1e-9);
    // One σ inside the edge: Φ(1).
    assert!((probability(21.5, 15.0, 1.0) - 0.841_344_746).abs() < 1e-6);
}
