//! How much a place of a photo looks like one tag: correlation of its cells with the tag's own.

use image::GrayImage;

use super::border::level;
use super::{TagHomography, TagImage};

/// Samples along each side of a cell: how far from its middle they are, in cells.
pub(super) const FINE: [f64; 3] = [-0.25, 0.0, 0.25];
/// The middle of each cell alone: nine times as fast as [`FINE`].
pub(super) const ROUGH: [f64; 1] = [0.0];

/// A tag's cells as they would correlate: +1 white, −1 black.
pub(super) struct CellPattern {
    cells: Vec<Cell>,
}

/// One cell: its middle in shares of the outline, and what it should be.
struct Cell {
    u: f64,
    v: f64,
    white: f64,
    /// It differs between the tags of the family.
    is_code: bool,
}

/// Correlations from −1 to 1 of a place with a tag.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Likeness {
    /// Of all cells, border and white ring included.
    pub of_all: f64,
    /// Of those that make the code.
    pub of_code: f64,
}

impl CellPattern {
    /// The cells of a tag with its white ring.
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
        }
    }

    /// How much a place looks like the tag, by samples of each cell so far from its middle each way ([`FINE`] or [`ROUGH`]); `None` where it leaves
    /// the image or is of one tone.
    pub(super) fn likeness(&self, grey: &GrayImage, corners_px: &[[f64; 2]; 4], samples: &[f64]) -> Option<Likeness> {
        let homography = TagHomography::to(corners_px);
        // Neighbouring cells are a cell apart.
        let cell_share = self.cells.get(1).map_or(0.0, |second| second.u - self.cells[0].u);
        let tone = |cell: &Cell| {
            let mut sum = 0.0;
            for u in samples {
                for v in samples {
                    let [u, v] = [cell.u + u * cell_share, cell.v + v * cell_share];
                    sum += level(grey, homography.pixel(u, v))?;
                }
            }
            Some(sum)
        };
        let tones: Vec<f64> = self.cells.iter().map(tone).collect::<Option<_>>()?;
        let correlation = |is_wanted: fn(&Cell) -> bool| {
            let wanted = self.cells.iter().zip(&tones).filter(|(cell, _)| is_wanted(cell));
            pearson(&wanted.map(|(cell, tone)| (cell.white, *tone)).collect::<Vec<_>>())
        };
        Some(Likeness {
            of_all: correlation(|_| true)?,
            of_code: correlation(|cell| cell.is_code)?,
        })
    }
}

/// Pearson's correlation coefficient; `None` where one side does not vary.
fn pearson(pairs: &[(f64, f64)]) -> Option<f64> {
    let n = pairs.len() as f64;
    let (sum_a, sum_b) = pairs.iter().fold((0.0, 0.0), |(a, b), pair| (a + pair.0, b + pair.1));
    let (mean_a, mean_b) = (sum_a / n, sum_b / n);
    let (mut both, mut of_a, mut of_b) = (0.0, 0.0, 0.0);
    for (a, b) in pairs {
        let (a, b) = (a - mean_a, b - mean_b);
        both += a * b;
        of_a += a * a;
        of_b += b * b;
    }
    let norm = (of_a * of_b).sqrt();
    (norm > 0.0).then(|| both / norm)
}
