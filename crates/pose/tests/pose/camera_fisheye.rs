//! The fisheye against OpenCV's, and where it ends.

use nalgebra::Point3;
use proptest::prelude::*;
use scaleproof_pose::camera::projection::project_unchecked;
use scaleproof_pose::camera::{Camera, DistortionModel};

fn camera() -> Camera {
    Camera::pinhole(1280, 960, 310.0, 312.0, 641.5, 478.25).with_fisheye([0.02, -0.004, 0.0015, -0.0004])
}

/// Points 0° to 84° off the axis, and their pixels by `cv2.fisheye.projectPoints(points, zeros(3), zeros(3), K, D)` of OpenCV 5.0.0.
const OPENCV: [([f64; 3], [f64; 2]); 7] = [
    ([0.0, 0.0, 500.0], [641.5, 478.25]),
    ([81.588, 29.696, 492.404], [692.3730650362943, 496.8859901229605]),
    ([-43.412, -246.202, 433.013], [613.1673550018838, 316.53071876114427]),
    ([-359.923, -131.001, 321.394], [383.87245929755534, 383.87647025503554]),
    ([117.285, 437.713, 211.309], [734.4536380303184, 827.3953522535376]),
    ([369.971, -310.443, 129.41], [960.6280542712992, 208.74174462523945]),
    ([-319.633, 380.924, 52.264], [340.3464719180332, 839.4665003926548]),
];

#[test]
fn points_land_where_opencv_projects_them() {
    for (point, expected) in OPENCV {
        let found = camera().project(&point.into()).unwrap();
        let off = (found[0] - expected[0]).hypot(found[1] - expected[1]);
        assert!(off < 1e-9, "{point:?}: {found:?}, OpenCV {expected:?}");
    }
}

proptest! {
    /// Derivatives by the point and by the camera, from the axis to 80° off it.
    #[test]
    fn the_derivatives_are_those_of_finite_differences(
        off_axis_deg in prop_oneof![Just(0.0), Just(1e-6), 0.0..80.0_f64], around_deg in 0.0..360.0_f64, distance_mm in 100.0..900.0_f64,
    ) {
        let (angle, around) = (off_axis_deg.to_radians(), around_deg.to_radians());
        let direction = [angle.sin() * around.cos(), angle.sin() * around.sin(), angle.cos()];
        let point = Point3::from(direction.map(|d| distance_mm * d));
        let parameters = camera().parameters();
        let at = project_unchecked(&parameters, &point);
        prop_assert_eq!(camera().project(&point), Some(at.pixel));
        prop_assert_eq!(camera().project_by_point(&point), Some((at.pixel, at.by_point)));
        for axis in 0..3 + 8 {
            let half = [1e-3, 1e-3, 1e-3, 1e-3, 1e-3, 1e-3, 1e-3, 1e-6, 1e-6, 1e-6, 1e-6][axis];
            let pixel = |sign: f64| {
                let (mut moved, mut of) = (point, parameters);
                if axis < 3 {
                    moved[axis] += sign * half;
                } else {
                    of.values[axis - 3] += sign * half;
                }
                project_unchecked(&of, &moved).pixel
            };
            let (after, before) = (pixel(1.0), pixel(-1.0));
            for row in 0..2 {
                let difference = (after[row] - before[row]) / (2.0 * half);
                let ours = if axis < 3 { at.by_point[(row, axis)] } else { at.by_camera[(row, axis - 3)] };
                let off = (ours - difference).abs();
                prop_assert!(off < 1e-5 * (1.0 + difference.abs()), "row {row}, axis {axis}: {ours}, {difference}");
            }
        }
    }

    /// A pixel looks where it is seen, for lenses from an orthographic fisheye to beyond a stereographic one; and none looks where none is seen.
    #[test]
    fn a_pixel_looks_where_it_is_seen(
        k in (-0.16..0.08_f64, -0.01..0.01_f64, -0.003..0.003_f64, -0.0005..0.0005_f64), off_axis_deg in 0.0..90.0_f64, around_deg in 0.0..360.0_f64,
    ) {
        let camera = camera().with_distortion(&[k.0, k.1, k.2, k.3]);
        let (radius, around) = (off_axis_deg.to_radians().tan(), around_deg.to_radians());
        let [x, y] = [radius * around.cos(), radius * around.sin()];
        match camera.project(&Point3::new(x, y, 1.0)) {
            Some(pixel) => {
                prop_assert!(radius <= camera.widest_radius());
                let [u, v] = camera.point_at(pixel).unwrap();
                let again = camera.project(&Point3::new(u, v, 1.0)).unwrap();
                prop_assert!((again[0] - pixel[0]).hypot(again[1] - pixel[1]) < 1e-9, "{again:?} {pixel:?}");
                // Where the image shrinks to nothing its edge, a hair in pixels is more in the ray.
                let is_inside = radius < 0.8 * camera.widest_radius();
                prop_assert!(!is_inside || (u - x).hypot(v - y) < 1e-8 * (1.0 + radius * radius), "{u} {v}");
            }
            None => prop_assert!(radius > camera.widest_radius()),
        }
    }
}

#[test]
fn a_fisheye_ends_where_its_radius_stops_growing_or_at_85_degrees() {
    let off_axis = |deg: f64| Point3::new(deg.to_radians().sin(), 0.0, deg.to_radians().cos());
    let equidistant = camera().with_fisheye([0.0; 4]);
    let [x, y] = equidistant.project(&off_axis(84.9)).unwrap();
    assert!((x - 641.5 - 310.0 * 84.9_f64.to_radians()).abs() < 1e-9 && (y - 478.25).abs() < 1e-9);
    for deg in [85.1, 90.0, 120.0, 180.0] {
        assert_eq!(equidistant.project(&off_axis(deg)), None, "{deg}°");
    }
    assert_eq!(
        equidistant.point_at([641.5 + 310.0 * 86_f64.to_radians(), 478.25]),
        None
    );
    assert_eq!(equidistant.point_at([641.5, 478.25]), Some([0.0; 2]));
    // θ − θ³/3 grows up to θ = 1 rad = 57.3°, where it is 2/3.
    let folded = camera().with_fisheye([-1.0 / 3.0, 0.0, 0.0, 0.0]);
    assert!(folded.project(&off_axis(56.9)).is_some());
    assert_eq!(folded.project(&off_axis(57.6)), None);
    assert!(folded.point_at([641.5 + 310.0 * 0.66, 478.25]).is_some());
    assert_eq!(folded.point_at([641.5 + 310.0 * 0.67, 478.25]), None);
}

/// Whoever takes coefficients away from a fisheye has an equidistant lens, and no pinhole.
#[test]
fn a_fisheye_stays_one() {
    let bare = camera().with_distortion(&[]);
    assert_eq!(
        (bare.distortion_model(), bare.distortion()),
        (DistortionModel::Fisheye, &[0.0; 4][..])
    );
    assert_eq!(bare, camera().with_fisheye([0.0; 4]));
    assert_eq!(camera().with_distortion(&[0.1; 8]).distortion(), [0.1; 4]);
    assert_ne!(bare, Camera::pinhole(1280, 960, 310.0, 312.0, 641.5, 478.25));
}
