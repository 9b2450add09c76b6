//! Penalties on a pattern: for not being smooth, and for the distance to another. Values and gradients, of cells as sRGB of 0 to 1.

use super::cells::Rgb;

/// Term under the root that keeps it differentiable where neighbours are equal.
const SOFT: f64 = 1e-6;

/// Computes the total variation (Mahendran & Vedaldi, CVPR 2015, with exponent 1/2): the mean over cells of the distance to the
/// neighbours on the right and below, round and round, for the pattern is repeated. Several square patterns, as those of the
/// sides, lie below each other, and none has a neighbour in another.
pub fn smooth(cells: &[Rgb], columns: usize) -> (f64, Vec<Rgb>) {
    let count = cells.len() as f64;
    let mut gradient = vec![[0.0; 3]; cells.len()];
    let mut sum = 0.0;
    for i in 0..cells.len() {
        let (column, row, pattern) = (i % columns, i / columns % columns, i / (columns * columns));
        let of = |column: usize, row: usize| (pattern * columns + row % columns) * columns + column % columns;
        let neighbours = [of(column + 1, row), of(column, row + 1)];
        let squares: f64 = neighbours.iter().map(|j| squared(cells[*j], cells[i])).sum();
        let length = (squares + SOFT).sqrt();
        sum += length;
        for j in neighbours {
            for c in 0..3 {
                let derivative = (cells[j][c] - cells[i][c]) / length / count;
                gradient[j][c] += derivative;
                gradient[i][c] -= derivative;
            }
        }
    }
    (sum / count, gradient)
}

/// Computes the mean over cells of the squared distance to those of another pattern.
pub fn distance(cells: &[Rgb], others: &[Rgb]) -> (f64, Vec<Rgb>) {
    let count = cells.len() as f64;
    let both = || cells.iter().zip(others);
    let gradient = both().map(|(cell, other)| std::array::from_fn(|c| 2.0 * (cell[c] - other[c]) / count));
    let sum: f64 = both().map(|(cell, other)| squared(*cell, *other)).sum();
    (sum / count, gradient.collect())
}

/// Returns the nearest of some colours, the first of equals.
pub fn nearest(cell: Rgb, colours: &[Rgb]) -> Option<Rgb> {
    let colours = colours.iter().copied();
    colours.min_by(|a, b| squared(cell, *a).total_cmp(&squared(cell, *b)))
}

fn squared(a: Rgb, b: Rgb) -> f64 {
    (0..3).map(|c| (a[c] - b[c]).powi(2)).sum()
}
