//! Where the ground mat is cut.

use proptest::prelude::*;
use scaleproof_print::tags::seams::SeamAxis;

fn axis(size: f64, keep: Vec<(f64, f64)>) -> SeamAxis {
    SeamAxis {
        low_mm: -size / 2.0,
        high_mm: size / 2.0,
        usable_mm: 180.0,
        overlap_mm: 8.0,
        keep,
    }
}

#[test]
fn a_seam_steps_aside_for_a_tag() {
    assert_eq!(axis(300.0, vec![]).edges(), [-176.0, -4.0, 176.0]);
    // 31 mm to either side of the middle, and 300 mm leave the seam 52 mm to move.
    let edges = axis(300.0, vec![(-5.0, 60.0)]).edges();
    assert!((edges[1] + 15.0).abs() < 0.6, "{edges:?}");
}

#[test]
fn what_cannot_be_avoided_cuts_the_fewest() {
    let edges = axis(340.0, vec![(-30.0, 5.0), (-30.0, 2.0), (-30.0, 60.0)]).edges();
    // The seam has from -10 to 2 mm, where it runs past one of the three.
    assert_eq!(edges[1], 2.0, "{edges:?}");
}

proptest! {
    #[test]
    fn every_sheet_has_room_and_all_is_covered(size in 20.0..1500.0_f64, tags in prop::collection::vec((-700.0..700.0_f64, 10.0..90.0_f64), 0..9)) {
        let axis = axis(size, tags.iter().map(|(at, wide)| (*at, at + wide)).collect());
        let edges = axis.edges();
        prop_assert_eq!(edges.len(), axis.sheets() + 1);
        prop_assert!(edges[0] <= axis.low_mm + 1e-6 && edges[edges.len() - 1] >= axis.high_mm - 1e-6);
        for (i, pair) in edges.windows(2).enumerate() {
            let overlap = if i + 2 == edges.len() { 0.0 } else { 8.0 };
            prop_assert!(pair[1] - pair[0] > 0.0 && pair[1] - pair[0] + overlap <= 180.0 + 1e-6, "{edges:?}");
        }
    }
}
