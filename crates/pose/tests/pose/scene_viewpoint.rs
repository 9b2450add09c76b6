//! Viewpoints and camera centres.

use nalgebra::Point3;
use proptest::prelude::*;
use scaleproof_core::geometry::angle::turn;
use scaleproof_pose::scene::Viewpoint;

#[test]
fn ninety_degrees_is_the_left_side() {
    let v = Viewpoint::from_camera(Point3::new(0.0, 500.0, 64.0), Point3::new(0.0, 0.0, 64.0));
    assert_eq!((v.azimuth_deg, v.pitch_deg, v.distance_mm), (90.0, 0.0, 500.0));
}

proptest! {
    #[test]
    fn camera_centres_round_trip(azimuth in 0.0..360.0_f64, pitch in -80.0..80.0_f64, distance in 100.0..3000.0_f64) {
        let target = Point3::new(0.0, 0.0, 64.5);
        let v = Viewpoint { azimuth_deg: azimuth, pitch_deg: pitch, distance_mm: distance };
        let back = Viewpoint::from_camera(v.camera_centre_mm(target), target);
        prop_assert!(turn(back.azimuth_deg, azimuth).abs() < 1e-9);
        prop_assert!((back.pitch_deg - pitch).abs() < 1e-9 && (back.distance_mm - distance).abs() < 1e-9);
    }
}
