//! Rectangles on pages: in rows from the top left, in their order.

use crate::print::sheet::{PointMm, RectMm};

/// Free paper between two things, for scissors.
const GAP_MM: f64 = 4.0;

/// Where a thing lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spot {
    /// From 0.
    pub page: usize,
    /// Its lower left corner (page frame).
    pub at: PointMm,
}

/// Puts things of some (width, height) into an area, page after page.
///
/// # Errors
/// The index of the first thing that is larger than the area.
pub fn pack(sizes: &[(f64, f64)], area: RectMm) -> Result<Vec<Spot>, usize> {
    let (mut page, mut x, mut top, mut row_mm) = (0, area.left_mm, area.top_mm, 0.0_f64);
    let mut spots = Vec::with_capacity(sizes.len());
    for (i, (width, height)) in sizes.iter().enumerate() {
        if *width > area.width_mm() || *height > area.height_mm() {
            return Err(i);
        }
        if x + width > area.right_mm {
            (x, top, row_mm) = (area.left_mm, top - row_mm - GAP_MM, 0.0);
        }
        if top - height < area.bottom_mm {
            (page, x, top, row_mm) = (page + 1, area.left_mm, area.top_mm, 0.0);
        }
        spots.push(Spot {
            page,
            at: PointMm::new(x, top - height),
        });
        x += width + GAP_MM;
        row_mm = row_mm.max(*height);
    }
    Ok(spots)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn things_lie_inside_and_apart(sizes in prop::collection::vec((1.0..80.0_f64, 1.0..90.0_f64), 1..40)) {
            let area = RectMm::new(10.0, 20.0, 90.0, 110.0);
            let spots = pack(&sizes, area).unwrap();
            for (i, (spot, size)) in spots.iter().zip(&sizes).enumerate() {
                prop_assert!(spot.at.x_mm >= 10.0 && spot.at.x_mm + size.0 <= 90.0 + 1e-9);
                prop_assert!(spot.at.y_mm >= 20.0 - 1e-9 && spot.at.y_mm + size.1 <= 110.0 + 1e-9);
                for (other, other_size) in spots.iter().zip(&sizes).take(i).filter(|(o, _)| o.page == spot.page) {
                    let apart = |a: f64, a_size: f64, b: f64, b_size: f64| a + a_size <= b + 1e-9 || b + b_size <= a + 1e-9;
                    prop_assert!(apart(spot.at.x_mm, size.0, other.at.x_mm, other_size.0)
                        || apart(spot.at.y_mm, size.1, other.at.y_mm, other_size.1));
                }
            }
        }
    }

    #[test]
    fn a_thing_too_large_is_named() {
        assert_eq!(
            pack(&[(5.0, 5.0), (11.0, 5.0)], RectMm::new(0.0, 0.0, 10.0, 10.0)),
            Err(1)
        );
    }
}
