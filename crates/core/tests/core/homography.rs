//! Fitted homographies.

use nalgebra::Matrix3;
use proptest::prelude::*;
use scaleproof_core::geometry::homography::{fitted, mapped};

fn squares(map: &Matrix3<f64>, from: &[[f64; 2]], to: &[[f64; 2]]) -> f64 {
    let off = |(point, seen): (&[f64; 2], &[f64; 2])| {
        let [u, v] = mapped(map, *point);
        (u - seen[0]).powi(2) + (v - seen[1]).powi(2)
    };
    from.iter().zip(to).map(off).sum()
}

const SQUARE: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];

proptest! {
    /// Any four corners that make a convex quadrilateral are met, and a fifth point follows.
    #[test]
    fn four_corners_are_met(shift in prop::array::uniform4(prop::array::uniform2(-0.4..0.4_f64)), scale in 0.1..1000.0_f64) {
        let to: Vec<_> = (0..4).map(|i| [0, 1].map(|k| scale * (SQUARE[i][k] + shift[i][k] + 3.0))).collect();
        let map = fitted(&SQUARE, &to).unwrap();
        for (point, seen) in SQUARE.iter().zip(&to) {
            let [u, v] = mapped(&map, *point);
            prop_assert!((u - seen[0]).hypot(v - seen[1]) < 1e-7 * scale);
        }
    }

    /// The fit of noisy points is no worse than the map they were made with.
    #[test]
    fn the_least_squares_are_least(noise in prop::collection::vec(prop::array::uniform2(-0.5..0.5_f64), 20), tilt in -0.002..0.002_f64) {
        let truth = Matrix3::new(3.0, 0.2, 50.0, -0.1, 2.8, 70.0, tilt, -tilt, 1.0);
        let from: Vec<_> = (0..20).map(|i| [f64::from(i % 5) * 40.0, f64::from(i / 5) * 30.0]).collect();
        let to: Vec<_> = from.iter().zip(&noise).map(|(p, n)| { let [u, v] = mapped(&truth, *p); [u + n[0], v + n[1]] }).collect();
        let map = fitted(&from, &to).unwrap();
        let best = squares(&map, &from, &to);
        prop_assert!(best <= squares(&truth, &from, &to));
        // A minimum: no small change of any number makes it better.
        for i in 0..9 {
            for by in [-1e-5, 1e-5] {
                let mut other = map;
                other[i] *= 1.0 + by;
                prop_assert!(squares(&other, &from, &to) >= best - 1e-9);
            }
        }
    }
}

#[test]
fn points_on_a_line_have_no_map() {
    let line: Vec<_> = (0..6).map(|i| [f64::from(i), 2.0 * f64::from(i)]).collect();
    assert_eq!(fitted(&line, &line), None);
    assert_eq!(fitted(&SQUARE[..3], &SQUARE[..3]), None);
    assert_eq!(fitted(&[[1.0, 1.0]; 4], &SQUARE), None);
    assert_eq!(
        fitted(&[[f64::NAN, 1.0], [0.0, 0.0], [1.0, 0.0], [1.0, 1.0]], &SQUARE),
        None
    );
}
