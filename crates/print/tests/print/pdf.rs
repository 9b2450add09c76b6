//! Lengths in a PDF.

use scaleproof_print::pdf::pt;

#[test]
fn positions_hold_over_the_largest_page() {
    for tenths in 0..50_000 {
        let mm = f64::from(tenths) / 10.0;
        let back = f64::from(pt(mm).0) * 25.4 / 72.0;
        assert!((back - mm).abs() < 0.001, "{mm} came back as {back}");
    }
}
