//! Angles.

use proptest::prelude::*;
use scaleproof_core::geometry::angle::{direction_text, turn, wrap_360};

#[test]
fn a_tiny_negative_angle_stays_below_360() {
    assert_eq!(wrap_360(-1e-18), 0.0);
}

#[test]
fn what_rounds_to_360_is_0() {
    assert_eq!(direction_text(359.996, 2), "0.00");
    assert_eq!(direction_text(359.994, 2), "359.99");
    assert_eq!(direction_text(45.06, 1), "45.1");
}

#[test]
fn the_turn_takes_the_short_way() {
    assert_eq!(turn(350.0, 10.0), 20.0);
    assert_eq!(turn(10.0, 350.0), -20.0);
}

proptest! {
    #[test]
    fn turning_by_the_turn_arrives(from in -720.0..720.0_f64, to in -720.0..720.0_f64) {
        let there = wrap_360(from + turn(from, to));
        prop_assert!(turn(there, to).abs() < 1e-9);
    }

    #[test]
    fn wrapped_angles_are_in_range(deg in -1e6..1e6_f64) {
        prop_assert!((0.0..360.0).contains(&wrap_360(deg)));
    }
}
