//! Rectangles on pages.

use proptest::prelude::*;
use scaleproof_print::pack::{Spot, tight};
use scaleproof_print::sheet::RectMm;

proptest! {
    #[test]
    fn things_lie_inside_and_apart(sizes in prop::collection::vec((1.0..80.0_f64, 1.0..90.0_f64), 1..40)) {
        let area = RectMm::new(10.0, 20.0, 90.0, 110.0);
        let spots = tight(&sizes, area).unwrap();
        for (i, (spot, size)) in spots.iter().zip(&sizes).enumerate() {
            prop_assert!(spot.at[0] >= 10.0 && spot.at[0] + size.0 <= 90.0 + 1e-9);
            prop_assert!(spot.at[1] >= 20.0 - 1e-9 && spot.at[1] + size.1 <= 110.0 + 1e-9);
            for (other, other_size) in spots.iter().zip(&sizes).take(i).filter(|(o, _)| o.page == spot.page) {
                let apart = |a: f64, a_size: f64, b: f64, b_size: f64| a + a_size <= b + 1e-9 || b + b_size <= a + 1e-9;
                prop_assert!(apart(spot.at[0], size.0, other.at[0], other_size.0)
                    || apart(spot.at[1], size.1, other.at[1], other_size.1));
            }
        }
    }
}

#[test]
fn what_is_flat_goes_into_the_space_that_high_things_leave() {
    let area = RectMm::new(0.0, 0.0, 180.0, 254.0);
    let sizes: Vec<_> = [(86.5, 211.5); 8].into_iter().chain([(170.0, 36.0); 4]).collect();
    let pages = |spots: Vec<Spot>| spots.iter().map(|spot| spot.page + 1).max();
    assert_eq!(pages(tight(&sizes, area).unwrap()), Some(4));
}

#[test]
fn a_thing_too_large_is_named() {
    assert_eq!(
        tight(&[(5.0, 5.0), (11.0, 5.0)], RectMm::new(0.0, 0.0, 10.0, 10.0)),
        Err(1)
    );
}
