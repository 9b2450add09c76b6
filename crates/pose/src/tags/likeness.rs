//! How much a place of a photo looks like one tag: correlation of its cells with the tag's own.

use image::GrayImage;

use super::border::level;
use super::{TagHomography, TagImage};

/// Samples along each side of a cell: how far from its middle they are, in cells.
const SAMPLES: [f64; 3] = [-0.25, 0.0, 0.25];

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

    /// How much a place looks like the tag, by nine samples of each cell; `None` where it leaves the image or is of one tone.
    pub(super) fn likeness(&self, grey: &GrayImage, corners_px: &[[f64; 2]; 4]) -> Option<Likeness> {
        let homography = TagHomography::to(corners_px);
        // Neighbouring cells are a cell apart.
        let cell_share = self.cells.get(1).map_or(0.0, |second| second.u - self.cells[0].u);
        let (mut all, mut code) = (Correlation::default(), Correlation::default());
        for cell in &self.cells {
            let mut tone = 0.0;
            for u in SAMPLES {
                for v in SAMPLES {
                    let [u, v] = [cell.u + u * cell_share, cell.v + v * cell_share];
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

    /// The cells' middles where a tag's corners are, for [`Middles::likeness`] there and beside it.
    pub(super) fn middles(&self, corners_px: &[[f64; 2]; 4]) -> Middles {
        let homography = TagHomography::to(corners_px);
        let middle = |cell: &Cell| (cell.white, homography.pixel(cell.u, cell.v));
        Middles(self.cells.iter().map(middle).collect())
    }
}

/// What each cell of a tag should be, and where its middle is, px.
pub(super) struct Middles(Vec<(f64, [f64; 2])>);

impl Middles {
    /// As [`Likeness::of_all`] of the place moved by so many pixels, by the middles alone: more than nine times as fast.
    pub(super) fn likeness(&self, grey: &GrayImage, by: [f64; 2]) -> Option<f64> {
        let mut all = Correlation::default();
        for (white, [x, y]) in &self.0 {
            all.add(*white, level(grey, [x + by[0], y + by[1]])?);
        }
        all.coefficient()
    }
}

/// Pearson's correlation of whole numbers, which these sums hold exactly.
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

    /// `None` where one side does not vary.
    fn coefficient(&self) -> Option<f64> {
        let [of_a, of_b] = [0, 1].map(|i| self.count * self.squares[i] - self.sums[i] * self.sums[i]);
        let norm = (of_a * of_b).sqrt();
        (norm > 0.0).then(|| (self.count * self.product - self.sums[0] * self.sums[1]) / norm)
    }
}
