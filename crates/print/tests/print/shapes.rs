//! Outlines that are clipped, filled and overlap.

use proptest::prelude::*;
use scaleproof_core::geometry::Point2;
use scaleproof_pose::tags::Modules;
use scaleproof_print::shapes::{TagPlacement, black_modules, clipped, overlap};
use scaleproof_print::sheet::RectMm;

fn area(outline: &[Point2]) -> f64 {
    let next = outline.iter().cycle().skip(1);
    let doubled: f64 = outline.iter().zip(next).map(|(a, b)| a[0] * b[1] - b[0] * a[1]).sum();
    doubled / 2.0
}

proptest! {
    /// A square cut into the four quarters of a page keeps its area.
    #[test]
    fn cutting_loses_nothing(x in -5.0..5.0_f64, y in -5.0..5.0_f64, turn in 0.0..6.3_f64, at_x in -9.0..9.0_f64, at_y in -9.0..9.0_f64) {
        let place = TagPlacement { centre: [x, y], right: [turn.cos(), turn.sin()], module_mm: 1.0 };
        let square = place.rectangle(-3.0, -2.0, 3.0, 2.0);
        let quarters = [(-50.0, at_x, -50.0, at_y), (at_x, 50.0, -50.0, at_y), (-50.0, at_x, at_y, 50.0), (at_x, 50.0, at_y, 50.0)];
        let sum: f64 = quarters.iter().map(|(l, r, b, t)| area(&clipped(&square, RectMm::new(*l, *b, *r, *t)))).sum();
        prop_assert!((sum - 24.0).abs() < 1e-9, "{sum}");
    }
}

#[test]
fn black_runs_cover_the_black_modules() {
    let modules = Modules::new(5, |row, column| (row * 5 + column) % 3 == 0);
    let place = TagPlacement {
        centre: [7.0, 8.0],
        right: [0.6, 0.8],
        module_mm: 2.0,
    };
    let black: f64 = black_modules(&modules, &place).iter().map(|o| area(o)).sum();
    assert!((black - 9.0 * 4.0).abs() < 1e-9, "{black}");
}

#[test]
fn only_outlines_that_share_ground_overlap() {
    let square = |x: f64, y: f64| [(x, y), (x + 10.0, y), (x + 10.0, y + 10.0), (x, y + 10.0)].map(|(x, y)| [x, y]);
    let diamond = |x: f64, y: f64| [(x, y - 5.0), (x + 5.0, y), (x, y + 5.0), (x - 5.0, y)].map(|(x, y)| [x, y]);
    assert!(overlap(&square(0.0, 0.0), &square(9.0, 9.0)));
    assert!(!overlap(&square(0.0, 0.0), &square(10.0, 0.0)), "side by side");
    assert!(
        !overlap(&square(0.0, 0.0), &diamond(13.0, 13.0)),
        "their boxes overlap, they do not"
    );
    assert!(overlap(&square(0.0, 0.0), &diamond(5.0, 5.0)), "one inside the other");
}
