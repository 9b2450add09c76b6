//! Areas of the plane.

use scaleproof_print::wrap::{Contour, Region};

fn square(x: f64, y: f64, side: f64) -> Contour {
    vec![[x, y], [x + side, y], [x + side, y + side], [x, y + side]]
}

#[test]
fn areas_count_once_and_holes_not() {
    let mut clockwise = square(5.0, 0.0, 10.0);
    clockwise.reverse();
    let both = Region::union(vec![square(0.0, 0.0, 10.0), clockwise]);
    assert!((both.area_mm2() - 150.0).abs() < 1e-3, "{}", both.area_mm2());
    assert!(both.contains([12.0, 5.0]) && !both.contains([16.0, 5.0]));
    assert!((both.distance_mm([18.0, 5.0]) - 3.0).abs() < 1e-3);
    assert!((both.distance_mm([7.0, 4.0]) + 4.0).abs() < 1e-3);
    let grown = both.grown(1.0);
    let expected = 150.0 + 50.0 + std::f64::consts::PI;
    assert!((grown.area_mm2() - expected).abs() < 0.1, "{}", grown.area_mm2());
    // Four bars around a window.
    let bars = [[0.0, 0.0], [0.0, 7.0], [7.0, 0.0], [0.0, 0.0]];
    let frame = bars.iter().enumerate().map(|(i, [x, y])| {
        let (w, h) = if i < 2 { (10.0, 3.0) } else { (3.0, 10.0) };
        vec![[*x, *y], [x + w, *y], [x + w, y + h], [*x, y + h]]
    });
    let frame = Region::union(frame.collect());
    assert!((frame.area_mm2() - 84.0).abs() < 1e-3, "{}", frame.area_mm2());
    assert!(!frame.contains([5.0, 5.0]) && frame.grown(0.5).area_mm2() > 84.0 + 0.5 * 56.0 - 1.0);
    assert!((frame.and(&Region::union(vec![square(0.0, 0.0, 3.0)])).area_mm2() - 9.0).abs() < 1e-3);
}
