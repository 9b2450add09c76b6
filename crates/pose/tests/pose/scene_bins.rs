//! Viewpoint bins.

use scaleproof_pose::scene::{Bin, Bins, Viewpoint};

fn bins() -> Bins {
    Bins {
        azimuth_deg: 45.0,
        pitch_deg: vec![0.0, 15.0, 30.0],
        distance_mm: vec![500.0, 1000.0],
    }
}

fn at(azimuth_deg: f64, pitch_deg: f64, distance_mm: f64) -> Bin {
    bins().bin_of(&Viewpoint {
        azimuth_deg,
        pitch_deg,
        distance_mm,
    })
}

#[test]
fn the_front_bin_is_centred_on_the_front() {
    assert_eq!(at(22.4, 0.0, 500.0).azimuth_deg, 0.0);
    assert_eq!(at(22.6, 0.0, 500.0).azimuth_deg, 45.0);
    assert_eq!(at(337.6, 0.0, 500.0).azimuth_deg, 0.0);
    assert_eq!(at(337.4, 0.0, 500.0).azimuth_deg, 315.0);
}

#[test]
fn pitch_and_distance_take_the_nearest_centre() {
    let bin = at(0.0, 8.0, 760.0);
    assert_eq!((bin.pitch_deg, bin.distance_mm), (15.0, 1000.0));
}

#[test]
fn the_edge_is_half_a_step_from_the_centre() {
    assert!((bins().azimuth_to_edge_deg(359.0) - 21.5).abs() < 1e-9);
    assert!((bins().azimuth_to_edge_deg(22.0) - 0.5).abs() < 1e-9);
}
