//! Polygons shared between cells.

use scaleproof_print::polygon::{Affine, area, each_slice, within};

#[test]
fn a_square_is_shared_between_cells_by_area() {
    let triangle = [[-10.0, -10.0], [30.0, -10.0], [-10.0, 30.0]];
    // Columns of a width of 2, turned by the diagonal.
    let column = Affine::through(&triangle, triangle.map(|[x, y]| 0.5 * (x + y))).unwrap();
    let square = [[0.0, 0.0], [3.0, 0.0], [3.0, 3.0], [0.0, 3.0]];
    let mut found: Vec<(i64, f64)> = Vec::new();
    each_slice(&square, &column, column.cells(&square), |cell, part| {
        // The far corner may be a part by itself, without area.
        if area(part) > 1e-12 {
            found.push((cell, area(part)));
        }
    });
    // x + y from 0 to 2, 4 and 6.
    assert_eq!(found.len(), 3, "{found:?}");
    for ((cell, mm2), wanted) in found.iter().zip([(0, 2.0), (1, 5.0), (2, 2.0)]) {
        assert!(*cell == wanted.0 && (mm2 - wanted.1).abs() < 1e-12, "{found:?}");
    }
    let half = within(&square, &[[0.0, 0.0], [0.0, 3.0], [3.0, 3.0]]);
    assert!((area(&half) - 4.5).abs() < 1e-12, "{half:?}");
    assert!(Affine::through(&[[0.0; 2], [1.0; 2], [2.0; 2]], [0.0, 1.0, 2.0]).is_none());
}
