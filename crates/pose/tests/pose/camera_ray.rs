//! From a pixel back to its direction.

use nalgebra::Point3;
use proptest::prelude::*;
use scaleproof_pose::camera::Camera;

proptest! {
    /// Lenses from strong barrel to pincushion, tangential terms too.
    #[test]
    fn a_pixel_looks_where_it_is_seen(
        k1 in -0.25..0.25_f64, k2 in -0.05..0.05_f64, p1 in -0.01..0.01_f64, x in -0.6..0.6_f64, y in -0.45..0.45_f64,
    ) {
        let camera = Camera::pinhole(1280, 960, 1000.0, 990.0, 640.0, 470.0).with_distortion(&[k1, k2, p1, -p1]);
        if let Some(pixel) = camera.project(&Point3::new(x, y, 1.0)) {
            let [u, v] = camera.point_at(pixel).unwrap();
            prop_assert!((u - x).abs() < 1e-8 && (v - y).abs() < 1e-8, "{u} {v}");
        }
    }
}

#[test]
fn a_pixel_beyond_the_lens_model_looks_nowhere() {
    // Barrel distortion so strong that no direction lands further than 770 px from the centre.
    let camera = Camera::pinhole(2000, 2000, 1000.0, 1000.0, 1000.0, 1000.0).with_distortion(&[-0.25]);
    assert!(camera.point_at([1760.0, 1000.0]).is_some());
    assert_eq!(camera.point_at([1999.0, 1000.0]), None);
}
