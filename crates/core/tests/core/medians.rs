//! Medians.

use scaleproof_core::statistics::{median, upper_median};

#[test]
fn the_middle_of_odd_even_and_none() {
    for (values, mean, upper) in [
        (&[][..], None, None),
        (&[3.0], Some(3.0), Some(3.0)),
        (&[4.0, 1.0], Some(2.5), Some(4.0)),
        (&[9.0, -1.0, 2.0], Some(2.0), Some(2.0)),
    ] {
        assert_eq!((median(values), upper_median(values)), (mean, upper));
    }
}
