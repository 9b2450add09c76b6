//! Convex hulls.

use scaleproof_core::geometry::convex_hull;

#[test]
fn the_hull_has_the_outer_points_only() {
    let points = vec![[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [0.0, 3.0], [2.0, 1.0], [2.0, 0.0]];
    assert_eq!(convex_hull(points), [[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [0.0, 3.0]]);
}
