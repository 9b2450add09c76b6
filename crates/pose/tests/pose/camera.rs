//! Where a camera has no pixel.

use nalgebra::Point3;
use scaleproof_pose::camera::Camera;

#[test]
fn a_pixel_behind_the_camera_does_not_exist() {
    let camera = Camera::pinhole(640, 480, 500.0, 500.0, 319.5, 239.5);
    assert_eq!(camera.project(&Point3::new(0.0, 0.0, 1.0)), Some([319.5, 239.5]));
    assert_eq!(camera.project(&Point3::new(0.0, 0.0, -1.0)), None);
}

#[test]
fn strong_barrel_distortion_has_an_edge() {
    // r(1 - r²/4) grows up to r = sqrt(4/3).
    let camera = Camera::pinhole(640, 480, 500.0, 500.0, 319.5, 239.5).with_distortion(&[-0.25]);
    assert!(camera.project(&Point3::new(1.14, 0.0, 1.0)).is_some());
    assert_eq!(camera.project(&Point3::new(1.18, 0.0, 1.0)), None);
}
