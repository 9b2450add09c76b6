//! Similarity of an image region to a tag: correlation of its bit cells with the tag's own.

use image::GrayImage;

use super::border::level;
use super::{TagHomography, TagImage};

/// Pixel corners as in [`super::SeenTag`].
pub(super) type Corners = [[f64; 2]; 4];

/// Sampling positions along each side of a cell, relative to its centre, in cells.
const SAMPLES: [f64; 3] = [-0.25, 0.0, 0.25];

/// Bit cells of a tag as values to correlate: +1 white, −1 black.
pub(super) struct CellPattern {
    /// Cells row by row.
    cells: Vec<Cell>,
    /// Number of cells along each side.
    side: usize,
    /// Width of a cell, as a share of the outline.
    width: f64,
}

/// Cell: its centre in shares of the outline, and its expected tone.
struct Cell {
    u: f64,
    v: f64,
    white: f64,
    /// True if the cell differs between the tags of the family.
    is_code: bool,
}

/// Correlations of an image region with a tag, from −1 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Likeness {
    /// Correlation over all cells, border and white ring included.
    pub of_all: f64,
    /// Correlation over the cells of the code.
    pub of_code: f64,
}

impl CellPattern {
    /// Returns the cells of a tag with its white ring.
    pub(super) fn new(tag: &TagImage) -> CellPattern {
        let (modules, border) = (tag.modules(), tag.border_modules());
        let (side, first) = (modules.side(), (modules.side() - border) / 2);
        let middle = |i: usize| (i as f64 + 0.5 - first as f64) / border as f64;
        let on_border = |i: usize| i == first || i + 1 == first + border;
        let in_border = |i: usize| (first..first + border).contains(&i);
        let cell = |row: usize, column: usize| {
            let is_ring = (on_border(row) && in_border(column)) || (on_border(column) && in_border(row));
            let is_edge = [row, column].iter().any(|i| *i == 0 || *i + 1 == side);
            Cell {
                u: middle(column),
                v: middle(row),
                white: if modules.is_black(row, column) { -1.0 } else { 1.0 },
                is_code: !is_ring && !is_edge,
            }
        };
        let cells = (0..side).flat_map(|row| (0..side).map(move |column| (row, column)));
        CellPattern {
            cells: cells.map(|(row, column)| cell(row, column)).collect(),
            side,
            width: 1.0 / border as f64,
        }
    }

    /// Computes the likeness of a region to the tag, by nine samples per cell; `None` if it leaves the image or has one tone.
    pub(super) fn likeness(&self, grey: &GrayImage, corners_px: &Corners) -> Option<Likeness> {
        let homography = TagHomography::to(corners_px);
        let (mut all, mut code) = (Correlation::default(), Correlation::default());
        for cell in &self.cells {
            let mut tone = 0.0;
            for u in SAMPLES {
                for v in SAMPLES {
                    let [u, v] = [cell.u + u * self.width, cell.v + v * self.width];
                    tone += level(grey, homography.pixel(u, v))?;
                }
            }
            all.add(cell.white, tone);
            if cell.is_code {
                code.add(cell.white, tone);
            }
        }
        Some(Likeness {
            of_all: all.coefficient()?,
            of_code: code.coefficient()?,
        })
    }

    /// Returns the position at most `reach` half cells away that is most similar to the tag, with its correlation by the centres of all cells; `None`
    /// if every position leaves the image or has one tone.
    ///
    /// Centres of cells moved by half cells lie on one grid of half cells, which is sampled once.
    pub(super) fn most_alike(&self, grey: &GrayImage, corners_px: &Corners, reach: usize) -> Option<(Corners, f64)> {
        let homography = TagHomography::to(corners_px);
        let first = self.cells.first()?;
        let moved = |half_cells: usize| (half_cells as f64 - reach as f64) / 2.0 * self.width;
        let wide = 2 * self.side - 1 + 2 * reach;
        let points = (0..wide).flat_map(|row| (0..wide).map(move |column| (row, column)));
        let sample = |(row, column)| level(grey, homography.pixel(first.u + moved(column), first.v + moved(row)));
        let levels: Vec<Option<i64>> = points.map(|point| sample(point).map(|level| level as i64)).collect();
        let pattern: i64 = self.cells.iter().map(|cell| cell.white as i64).sum();
        let alike_at = |place| self.correlation_on(&levels, wide, place, pattern)?.coefficient();
        let places = (0..=2 * reach).flat_map(|down| (0..=2 * reach).map(move |right| (down, right)));
        let alike = places.filter_map(|place| Some((place, alike_at(place)?)));
        let ((down, right), most) = alike.max_by(|a, b| a.1.total_cmp(&b.1))?;
        let (u, v) = (moved(right), moved(down));
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        Some((corners.map(|[x, y]| homography.pixel(x + u, y + v)), most))
    }

    /// Computes the correlation of all cells by their centres, at a position half cells down and right on a grid of levels. `pattern`: the sum of all
    /// cells' `white`.
    fn correlation_on(
        &self,
        levels: &[Option<i64>],
        wide: usize,
        (down, right): (usize, usize),
        pattern: i64,
    ) -> Option<Correlation> {
        let (mut white, mut sum, mut squares) = (0, 0, 0);
        for (row, cells) in self.cells.chunks_exact(self.side).enumerate() {
            let line = &levels[(2 * row + down) * wide + right..];
            for (cell, level) in cells.iter().zip(line.iter().step_by(2)) {
                let level = (*level)?;
                sum += level;
                squares += level * level;
                white += if cell.white > 0.0 { level } else { 0 };
            }
        }
        let count = self.cells.len() as f64;
        Some(Correlation {
            count,
            sums: [pattern as f64, sum as f64],
            squares: [count, squares as f64],
            product: (2 * white - sum) as f64,
        })
    }
}

/// Sums for Pearson's correlation of whole numbers, exact in floating point.
#[derive(Default)]
struct Correlation {
    count: f64,
    sums: [f64; 2],
    squares: [f64; 2],
    product: f64,
}

impl Correlation {
    fn add(&mut self, a: f64, b: f64) {
        self.count += 1.0;
        self.sums = [self.sums[0] + a, self.sums[1] + b];
        self.squares = [self.squares[0] + a * a, self.squares[1] + b * b];
        self.product += a * b;
    }

    /// Returns the correlation; `None` if one variable is constant.
    fn coefficient(&self) -> Option<f64> {
        let [of_a, of_b] = [0, 1].map(|i| self.count * self.squares[i] - self.sums[i] * self.sums[i]);
        let norm = (of_a * of_b).sqrt();
        (norm > 0.0).then(|| (self.count * self.product - self.sums[0] * self.sums[1]) / norm)
    }
}
