//! The way from where the camera is to the view that is required next.

use nalgebra::{Point3, Vector3};
use scaleproof_capture::{Guidance, NextMove, Tolerance};
use scaleproof_core::geometry::angle::turn;
use scaleproof_pose::scene::{Bins, Viewpoint};

fn bins() -> Bins {
    Bins {
        azimuth_deg: 45.0,
        pitch_deg: vec![0.0, 15.0, 30.0],
        distance_mm: vec![500.0, 1000.0, 1500.0, 2000.0],
    }
}

fn view(azimuth_deg: f64, pitch_deg: f64, distance_mm: f64) -> Viewpoint {
    Viewpoint {
        azimuth_deg,
        pitch_deg,
        distance_mm,
    }
}

fn tolerance() -> Tolerance {
    Tolerance::of_bins(&bins(), &[1000.0])
}

fn guidance(tolerance: Tolerance) -> Guidance {
    Guidance::at(&bins().viewpoints(&[15.0], &[1000.0]), tolerance, &bins())
}

/// Who faces the model and walks to the right gets to a larger azimuth, from every side.
#[test]
fn a_larger_azimuth_is_to_the_right_of_somebody_who_faces_the_model() {
    let target = Point3::new(0.0, 0.0, 64.0);
    for azimuth in [0.0, 100.0, 200.0, 300.0] {
        let here = view(azimuth, 15.0, 1000.0).camera_centre_mm(target);
        let right = (target - here).cross(&Vector3::z()).normalize();
        let there = Viewpoint::from_camera(here + 50.0 * right, target);
        assert!(turn(azimuth, there.azimuth_deg) > 1.0);
    }
}

#[test]
fn the_step_is_the_part_that_is_missing_most() {
    let g = guidance(tolerance());
    let step = |v: Viewpoint| g.step(g.nearest_open(&v).unwrap(), &v);
    assert_eq!(step(view(350.0, 15.0, 1000.0)), Some(NextMove::Azimuth(10.0)));
    assert_eq!(step(view(102.0, 15.0, 1000.0)), Some(NextMove::Azimuth(-12.0)));
    assert_eq!(step(view(90.0, 15.0, 1200.0)), Some(NextMove::Distance(-200.0)));
    let Some(NextMove::Height(up)) = step(view(90.0, 5.0, 1000.0)) else {
        panic!("the camera is 10° too low");
    };
    assert!((up - 171.7).abs() < 0.1, "1000 mm · (sin 15° − sin 5°), not {up}");
    assert_eq!(step(view(94.0, 12.0, 950.0)), None);
}

#[test]
fn a_photo_of_the_next_bin_fills_nothing_however_wide_the_tolerance() {
    let wide = Tolerance {
        azimuth_deg: 40.0,
        ..tolerance()
    };
    let g = guidance(wide);
    assert!(matches!(
        g.step(0, &view(24.0, 15.0, 1000.0)),
        Some(NextMove::Azimuth(_))
    ));
}

#[test]
fn filled_targets_are_left_and_reopened_ones_wanted_again() {
    let mut g = guidance(tolerance());
    let here = view(46.0, 15.0, 1000.0);
    g.fill(1, "a.jpg");
    assert_eq!(g.filled_at(&here).unwrap().bin.azimuth_deg, 45.0);
    let next = g.nearest_open(&here).unwrap();
    assert_eq!(g.targets()[next].bin.azimuth_deg, 90.0);
    g.reopen("a.jpg");
    assert_eq!(g.nearest_open(&here), Some(1));
    (0..8).for_each(|i| g.fill(i, "b.jpg"));
    assert!(g.is_finished() && g.nearest_open(&here).is_none());
}

#[test]
fn the_usual_pitch_and_distance_are_the_scene_s() {
    assert_eq!(bins().usual_view(), (15.0, 1000.0));
}
