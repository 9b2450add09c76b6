//! Points and triangles in a plane.

use proptest::prelude::*;
use scaleproof_core::geometry::{
    PlaneTriangle, UnionFind, between, circle, distance, doubled_area, extent, stretches, view_axes,
};

#[test]
fn an_area_has_the_sign_of_its_turn() {
    assert_eq!(doubled_area([0.0, 0.0], [4.0, 0.0], [0.0, 3.0]), 12.0);
    assert_eq!(doubled_area([0.0, 0.0], [0.0, 3.0], [4.0, 0.0]), -12.0);
    assert!(PlaneTriangle::new([[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]).is_none());
}

#[test]
fn a_circle_has_its_radius_and_an_extent_its_ends() {
    let corners: Vec<_> = circle([2.0, -1.0], 3.0, 12).collect();
    assert_eq!(corners.len(), 12);
    assert!(corners.iter().all(|p| (distance(*p, [2.0, -1.0]) - 3.0).abs() < 1e-12));
    let (low, high) = extent(corners.iter().map(|p| p[0]));
    assert!((low + 1.0).abs() < 1e-12 && (high - 5.0).abs() < 1e-12);
    assert_eq!(between([0.0, 2.0], [4.0, 0.0], 0.25), [1.0, 1.5]);
}

#[test]
fn a_viewer_at_the_front_has_the_models_left_at_the_right() {
    let [right, up, towards] = view_axes(0.0, 0.0);
    assert!((right - nalgebra::Vector3::y()).norm() < 1e-12 && (up - nalgebra::Vector3::z()).norm() < 1e-12);
    assert!((towards - nalgebra::Vector3::x()).norm() < 1e-12);
}

#[test]
fn united_sets_have_their_smallest_member_as_root() {
    let mut sets = UnionFind::new(6);
    sets.unite(4, 2);
    sets.unite(5, 4);
    assert_eq!([0, 1, 2, 3, 4, 5].map(|i| sets.root(i)), [0, 1, 2, 3, 2, 2]);
}

proptest! {
    /// A row of a sliver is short, and no cell in which a point counts as inside is left out of it.
    #[test]
    fn a_row_of_a_triangle_has_every_cell_that_it_covers(
        corners in prop::array::uniform3(prop::array::uniform2(-10.0..50.0_f64)), thin in prop::sample::select(vec![1.0, 1e-3, 1e-9]),
    ) {
        let [a, b, c] = corners;
        let Some(triangle) = PlaneTriangle::new([a, b, between(between(a, b, 0.3), c, thin)]) else {
            return Ok(());
        };
        for row in 0..40_i64 {
            let cells = triangle.cells_of_row(row, 0..40);
            for (column, point) in (0..40_i64).flat_map(|column| (0..25).map(move |point| (column, point))) {
                let at = |i: usize| (i as f64) / 4.0;
                let p = [column as f64 + at(point % 5), row as f64 + at(point / 5)];
                let is_last = point % 5 == 4 || point / 5 == 4; // these lie in the next cell
                prop_assert!(is_last || triangle.barycentric(p).is_none() || cells.contains(&column), "{column} {row} {cells:?}");
            }
        }
    }

    /// Both halves of a rectangle together draw each of its cells: no gap along the diagonal, and nothing outside.
    #[test]
    fn halves_of_a_rectangle_leave_no_gap(width in 1..20_usize, height in 1..20_usize) {
        let (right, top) = (width as f64, height as f64);
        let mut times = vec![0; 24 * 24];
        for corners in [[[0.0, 0.0], [right, 0.0], [right, top]], [[0.0, 0.0], [right, top], [0.0, top]]] {
            PlaneTriangle::new(corners).unwrap().draw([24, 24], 0.5, |column, row, shares| {
                times[row * 24 + column] += 1;
                assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            });
        }
        for (i, times) in times.into_iter().enumerate() {
            let is_inside = i % 24 < width && i / 24 < height;
            prop_assert_eq!(times > 0, is_inside);
        }
    }

    /// The point with the barycentric coordinates of a point is that point.
    #[test]
    fn shares_lead_back(corners in prop::array::uniform3(prop::array::uniform2(-50.0..50.0_f64)), s in 0.0..1.0_f64, t in 0.0..1.0_f64) {
        let [a, b, c] = corners;
        prop_assume!(doubled_area(a, b, c).abs() > 1.0);
        let p = between(a, between(b, c, s), t);
        let shares = PlaneTriangle::new(corners).unwrap().barycentric(p).unwrap();
        let back = [0, 1].map(|axis| (0..3).map(|i| shares[i] * corners[i][axis]).sum::<f64>());
        prop_assert!(distance(p, back) < 1e-9);
    }
}

#[test]
fn neighbours_join_into_stretches() {
    let differs = [false, true, true, false, true, false];
    assert_eq!(stretches(0..6, |i| differs[*i]), [1..3, 4..5]);
    assert_eq!(stretches(0..2, |_| false), []);
}
