//! The pattern on the sides of a model.

use nalgebra::{Point3, Vector3};
use scaleproof_surface::pattern::Pattern;
use scaleproof_surface::pattern::world_aligned::{Side, WorldAligned};

#[test]
fn every_side_is_seen_from_outside() {
    for side in Side::ALL {
        assert_eq!(Side::facing(&side.outward()), side);
    }
    // Somebody who looks at the left side has the model's front at the left hand, at the right side at the right hand.
    let nose = Point3::new(200.0, 0.0, 50.0);
    assert_eq!(Side::Left.project(&nose), [-200.0, 50.0]);
    assert_eq!(Side::Right.project(&nose), [200.0, 50.0]);
    // The model's left headlamp is at the right hand of who stands before it.
    assert_eq!(Side::Front.project(&Point3::new(200.0, 80.0, 50.0)), [80.0, 50.0]);
    assert_eq!(Side::Rear.project(&Point3::new(-200.0, 80.0, 50.0)), [-80.0, 50.0]);
    assert_eq!(Side::Roof.project(&Point3::new(200.0, 80.0, 120.0)), [-80.0, 200.0]);
}

#[test]
fn chamfers_belong_to_one_side_whatever_the_rounding() {
    for wobble in [-1e-6, 0.0, 1e-6] {
        assert_eq!(Side::facing(&Vector3::new(0.0, 1.0 + wobble, 1.0)), Side::Roof);
        assert_eq!(Side::facing(&Vector3::new(1.0 + wobble, -1.0, 0.0)), Side::Right);
        assert_eq!(Side::facing(&Vector3::new(1.0, 1.0, -1.0 + wobble)), Side::Bottom);
    }
    assert_eq!(Side::facing(&Vector3::zeros()), Side::Bottom);
}

#[test]
fn the_pattern_reads_from_left_to_right_and_down() {
    let pattern = Pattern::random(4, 3).unwrap();
    let texture = WorldAligned {
        pattern: &pattern,
        cell_mm: 10.0,
    };
    let cell = |column, row| pattern.cells().get_pixel(column, row).0;
    // Below the origin and to its right is the pattern's top-left cell; z is never negative, so rows count from the last.
    assert_eq!(texture.colour_at([5.0, -5.0]), cell(0, 0));
    assert_eq!(texture.colour_at([-5.0, 5.0]), cell(3, 3));
    assert_eq!(texture.colour_at([15.0, 5.0]), cell(1, 3));
    let left = Vector3::new(0.1, 0.9, 0.3);
    assert_eq!(texture.colour(&Point3::new(-15.0, 90.0, 25.0), &left), cell(1, 1));
    assert_eq!(texture.colour_at([-1e-300, 1e-300]), cell(3, 3));
}
