//! Convex polygons cut by half-planes.

use proptest::prelude::*;
use scaleproof_core::geometry::clip::{Corner, clipped};
use scaleproof_core::geometry::{Point2, circle, doubled_area};

fn area(polygon: &[Point2]) -> f64 {
    let fan = polygon
        .windows(2)
        .map(|pair| doubled_area(polygon[0], pair[0], pair[1]));
    0.5 * fan.sum::<f64>()
}

/// Signed distance from the line through the origin's `offset` along the direction of an angle.
fn beyond(angle: f64, offset: f64) -> impl Fn(&Point2) -> f64 {
    let (sin, cos) = angle.sin_cos();
    move |p| cos * p[0] + sin * p[1] - offset
}

#[derive(Clone, Copy)]
struct Weighted {
    at: Point2,
    weight: f64,
}

impl Corner for Weighted {
    fn along(self, end: Self, share: f64) -> Self {
        Self {
            at: self.at.along(end.at, share),
            weight: self.weight + share * (end.weight - self.weight),
        }
    }
}

#[test]
fn half_of_a_square_begins_with_its_first_corner_inside() {
    let square = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]];
    let right = clipped(&square, |p| p[0] - 1.0);
    assert_eq!(right, [[1.0, 0.0], [4.0, 0.0], [4.0, 4.0], [1.0, 4.0]]);
    assert_eq!(clipped(&square, |p| 4.0 - p[0]), square);
    assert!(clipped(&square, |p| p[1] - 5.0).is_empty());
    assert!(clipped::<Point2>(&[], |_| 1.0).is_empty());
}

proptest! {
    #[test]
    fn both_sides_of_a_line_are_the_whole_polygon(
        corners in 3_u32..12, radius in 0.1_f64..100.0, angle in 0.0_f64..6.3, offset in -1.2_f64..1.2,
    ) {
        let polygon: Vec<Point2> = circle([3.0, -2.0], radius, corners).collect();
        let side = beyond(angle, offset * radius);
        let inside = clipped(&polygon, &side);
        let outside = clipped(&polygon, |p| -side(p));
        prop_assert!(inside.iter().all(|p| side(p) >= -1e-9 * radius));
        let (whole, parts) = (area(&polygon), area(&inside) + area(&outside));
        prop_assert!((whole - parts).abs() < 1e-9 * radius * radius, "{whole} {parts}");
        // What is clipped stays as it is.
        let again = clipped(&inside, |p| side(p) + 1e-9 * radius);
        prop_assert_eq!(again, inside);
    }

    #[test]
    fn values_of_corners_stay_linear(angle in 0.0_f64..6.3, offset in -0.9_f64..0.9) {
        let weight = |p: Point2| 2.0 * p[0] - 3.0 * p[1] + 0.5;
        let polygon: Vec<Weighted> = circle([0.0; 2], 1.0, 7).map(|at| Weighted { at, weight: weight(at) }).collect();
        let side = beyond(angle, offset);
        for corner in clipped(&polygon, |corner| side(&corner.at)) {
            prop_assert!((corner.weight - weight(corner.at)).abs() < 1e-9);
        }
    }
}
