//! Exact areas of the plane.

use scaleproof_print::paint::plane::{Area, Bounds, PlaneOutline, PlanePoint, swept};

fn square(left: i32, bottom: i32, side: i32) -> PlaneOutline {
    Bounds {
        left,
        bottom,
        right: left + side,
        top: bottom + side,
    }
    .outline()
}

#[test]
fn growing_and_shrinking_are_exact() {
    let ring = Area::of(&[square(0, 0, 100)]).without(&Area::of(&[square(40, 40, 20)]));
    assert_eq!(ring.doubled_area(), 2 * (10_000 - 400));
    assert_eq!(ring.grown(5).doubled_area(), 2 * (110 * 110 - 100));
    assert_eq!(ring.shrunk(5).doubled_area(), 2 * (90 * 90 - 900));
    assert_eq!(ring.shrunk(20), Area::default());
    assert_eq!(ring.opened(5).doubled_area(), ring.doubled_area());
    // A spike of 4 goes, the rest stays.
    let spiked = ring.with(&[Bounds {
        left: 100,
        bottom: 10,
        right: 130,
        top: 14,
    }
    .outline()]);
    assert_eq!(spiked.opened(5).doubled_area(), ring.doubled_area());
}

#[test]
fn squares_that_touch_in_a_corner_are_two_pieces() {
    assert_eq!(Area::of(&[square(0, 0, 10), square(10, 10, 10)]).pieces.len(), 2);
    assert_eq!(Area::of(&[square(0, 0, 10), square(10, 0, 10)]).pieces.len(), 1);
}

#[test]
fn a_slanted_sweep_has_the_area_of_its_hexagon() {
    for (b, _) in [
        (PlanePoint::new(30, 40), 0),
        (PlanePoint::new(30, -40), 0),
        (PlanePoint::new(-30, 40), 0),
    ] {
        let made = Area::of(&[swept(PlanePoint::new(0, 0), b, 5)]);
        // The square, and its width and height times the way.
        assert_eq!(made.doubled_area(), 2 * (100 + 10 * 30 + 10 * 40));
    }
}
