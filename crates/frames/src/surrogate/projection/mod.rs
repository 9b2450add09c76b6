//! Where a pattern's cells lie in an image: a sparse linear map from cells to pixels, forward and transposed.
//!
//! Colours are linear reflectance, since a pixel that sees several cells sees the mean of their light.

pub mod repeated; // Repeated Texture Projection of DTA
pub mod world; // world-aligned, as the printed panels are

/// Grid of a pattern on the model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    /// Cells across.
    pub columns: u32,
    /// Cells down.
    pub rows: u32,
    /// Width and height of a cell on the model.
    pub cell_mm: f64,
}

impl Grid {
    /// Creates a grid whose repeat is `tile_mm` wide.
    pub fn new([columns, rows]: [u32; 2], tile_mm: f64) -> Self {
        Self {
            columns,
            rows,
            cell_mm: tile_mm / f64::from(columns),
        }
    }

    /// Counts the cells of one repeat.
    pub fn cells(&self) -> usize {
        self.columns as usize * self.rows as usize
    }
}

/// Linear map from the cells of a pattern (row by row from the top) to the pixels of an image (likewise).
///
/// A pixel that sees no paint gets the mean of all cells: what light it has from the paint comes from all over it.
#[derive(Debug, Clone, PartialEq)]
pub struct Projection {
    pub cells: usize,
    /// Index of each pixel's first entry, then the number of entries.
    pub starts: Vec<usize>,
    /// Cell and weight; the weights of a pixel add up to 1.
    entries: Vec<(u32, f64)>,
}

impl Projection {
    /// Creates the map from the points that each pixel sees, as positions in the pattern: columns to the right, rows down, in cells. A point has the
    /// colour of the cell it is in, as print has it.
    fn from_points(grid: &Grid, pixels: impl Iterator<Item = Vec<[f64; 2]>>) -> Self {
        let wrap = |v: f64, count: u32| (v.floor().rem_euclid(f64::from(count)) as u32) % count;
        let cell = |[column, row]: &[f64; 2]| wrap(*row, grid.rows) * grid.columns + wrap(*column, grid.columns);
        let (mut starts, mut entries) = (vec![0], Vec::<(u32, f64)>::new());
        for points in pixels {
            let share = 1.0 / points.len().max(1) as f64;
            let mut seen: Vec<u32> = points.iter().map(cell).collect();
            seen.sort_unstable();
            let alike = seen.chunk_by(|a, b| a == b);
            entries.extend(alike.map(|same| (same[0], same.iter().map(|_| share).sum())));
            starts.push(entries.len());
        }
        Self {
            cells: grid.cells(),
            starts,
            entries,
        }
    }

    /// Returns cell and weight of all pixels, of which each has those from its entry of `starts` to the next one's.
    pub fn entries(&self) -> &[(u32, f64)] {
        &self.entries
    }

    pub fn pixels(&self) -> usize {
        self.starts.len() - 1
    }

    /// Computes the paint in each pixel.
    ///
    /// # Panics
    /// When there are not `cells` colours.
    pub fn forward(&self, cells: &[[f64; 3]]) -> Vec<[f64; 3]> {
        assert_eq!(cells.len(), self.cells, "one colour a cell");
        let sum = cells.iter().fold([0.0; 3], |sum, c| plus(sum, *c));
        let mean = scaled(sum, 1.0 / self.cells as f64);
        let pixel = |window: &[usize]| {
            let entries = &self.entries[window[0]..window[1]];
            if entries.is_empty() {
                return mean;
            }
            let add = |sum, (cell, weight): &(u32, f64)| plus(sum, scaled(cells[*cell as usize], *weight));
            entries.iter().fold([0.0; 3], add)
        };
        self.starts.windows(2).map(pixel).collect()
    }

    /// Applies the transposed map: from the gradient with respect to each pixel's paint to that with respect to each cell.
    ///
    /// # Panics
    /// When there are not [`Projection::pixels`] values.
    pub fn transposed(&self, pixels: &[[f64; 3]]) -> Vec<[f64; 3]> {
        assert_eq!(pixels.len(), self.pixels(), "one value a pixel");
        let mut cells = vec![[0.0; 3]; self.cells];
        let mut everywhere = [0.0; 3];
        for (window, value) in self.starts.windows(2).zip(pixels) {
            let entries = &self.entries[window[0]..window[1]];
            if entries.is_empty() {
                everywhere = plus(everywhere, *value);
            }
            for (cell, weight) in entries {
                let cell = &mut cells[*cell as usize];
                *cell = plus(*cell, scaled(*value, *weight));
            }
        }
        let share = scaled(everywhere, 1.0 / self.cells as f64);
        cells.iter_mut().for_each(|cell| *cell = plus(*cell, share));
        cells
    }
}

fn plus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| a[i] + b[i])
}

fn scaled(a: [f64; 3], by: f64) -> [f64; 3] {
    a.map(|v| v * by)
}
