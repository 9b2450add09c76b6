//! Enlarged grids: images in which every cell of a pattern is a block of equal pixels, as far as a JPEG keeps them equal.
//!
//! In such an image, and in no photo, changes from pixel to pixel are at the borders of the blocks. So the changes along each side
//! are summed, and a number of cells is sought whose borders hold almost all of them.

use image::RgbImage;

use super::MAX_CELLS;
use super::area::averaged;
use scaleproof_core::statistics::upper_median;

/// Least block of a JPEG, px: smaller ones have no middle.
const LEAST_NOISY_BLOCK: u32 = 4;
/// Least share of the changes at borders, beyond chance, in a grid. Photos reach 0.1, grids in JPEGs of quality 40 stay above 0.85.
const LEAST_SHARE: f64 = 0.75;
/// Least share of the borders at which something changes. A grid with a border around it, or a gap, is hit by a finer grid most of whose borders hold
/// nothing.
const LEAST_BUSY: f64 = 0.5;
/// Share of the mean change at borders below which a border is inside of a cell.
const QUIET: f64 = 0.05;
/// Largest ratio of a block's sides: cells are square in a pattern; blocks may be off by rounding.
const MOST_OBLONG: f64 = 1.05;
/// Share of a block's sides that is averaged: blocks of a JPEG bleed into their neighbours.
const MIDDLE: f64 = 0.5;

/// Returns columns and rows of cells, if an image is an enlarged grid.
pub fn grid_of(image: &RgbImage) -> Option<[u32; 2]> {
    let [across, down] = [0, 1].map(|axis| Changes::along(image, axis));
    exact(&across, &down).or_else(|| noisy(&across, &down))
}

pub fn cells_of(image: &RgbImage, grid: [u32; 2]) -> RgbImage {
    averaged(image, grid, MIDDLE)
}

/// Change of the image from each pixel of a side to the next: the mean square over the other side.
struct Changes(Vec<f64>);

impl Changes {
    fn along(image: &RgbImage, axis: usize) -> Self {
        let (width, height) = image.dimensions();
        let (step, side) = if axis == 0 { ((1, 0), width) } else { ((0, 1), height) };
        let mut sums = vec![0.0; side as usize];
        let share = f64::from(side) / (f64::from(width) * f64::from(height));
        for y in step.1..height {
            for x in step.0..width {
                let (here, before) = (image.get_pixel(x, y).0, image.get_pixel(x - step.0, y - step.1).0);
                let squares = (0..3).map(|c| (f64::from(here[c]) - f64::from(before[c])).powi(2));
                sums[if axis == 0 { x } else { y } as usize] += share * squares.sum::<f64>();
            }
        }
        Self(sums)
    }

    fn pixels(&self) -> u32 {
        self.0.len() as u32
    }

    /// Returns the largest block of which every change is at a border.
    fn common_block(&self) -> u32 {
        let changed = (0..self.pixels()).zip(&self.0).filter(|(_, change)| **change > 0.0);
        changed.fold(self.pixels(), |block, (at, _)| gcd(block, at))
    }

    /// Returns the shares of busy borders, changes and pixels of a grid of `cells` cells along the side; changes count above the median.
    fn at_borders(&self, cells: u32) -> BorderShare {
        let noise = upper_median(&self.0[1..]).unwrap_or_default();
        let above = |at: usize| (self.0[at] - noise).max(0.0);
        let total: f64 = (1..self.0.len()).map(above).sum();
        let borders = self.borders(cells);
        let held: f64 = borders.iter().map(|at| above(*at)).sum();
        let mean = held / borders.len().max(1) as f64;
        let is_busy = |border: &u32| {
            let at = self.border(*border, cells);
            above(at.floor() as usize).max(above(at.ceil() as usize)) > QUIET * mean
        };
        let busy = (1..cells).filter(is_busy).count();
        BorderShare {
            of_busy: busy as f64 / f64::from(cells.saturating_sub(1).max(1)),
            of_changes: if total > 0.0 { held / total } else { 0.0 },
            of_pixels: borders.len() as f64 / (self.0.len() - 1).max(1) as f64,
        }
    }

    /// Returns the pixels that begin a block, and those before where the border is inside of a pixel.
    fn borders(&self, cells: u32) -> Vec<usize> {
        let at = (1..cells).map(|border| self.border(border, cells));
        let mut all: Vec<usize> = at
            .flat_map(|at| [at.floor(), at.ceil()].map(|at| at as usize))
            .collect();
        all.dedup();
        all
    }

    fn border(&self, border: u32, cells: u32) -> f64 {
        f64::from(border) * f64::from(self.pixels()) / f64::from(cells)
    }

    /// Returns the number of cells whose borders hold the most of the changes for their number.
    fn likeliest(&self) -> Option<u32> {
        let most = MAX_CELLS.min(self.pixels() / LEAST_NOISY_BLOCK);
        let all = (2..=most).map(|cells| (cells, self.at_borders(cells)));
        let best = all.max_by(|a, b| a.1.gain().total_cmp(&b.1.gain()));
        best.filter(|(_, share)| share.is_grid()).map(|(cells, _)| cells)
    }
}

/// Shares of a side that are at the borders of some cells.
struct BorderShare {
    /// Share of the borders at which something changes.
    of_busy: f64,
    of_changes: f64,
    of_pixels: f64,
}

impl BorderShare {
    fn gain(&self) -> f64 {
        self.of_changes - self.of_pixels
    }

    fn is_grid(&self) -> bool {
        self.of_busy >= LEAST_BUSY && self.gain() >= LEAST_SHARE * (1.0 - self.of_pixels)
    }
}

fn gcd(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// Returns the grid of square blocks of pixels that are equal to the bit.
fn exact(across: &Changes, down: &Changes) -> Option<[u32; 2]> {
    let block = gcd(across.common_block(), down.common_block());
    let cells = [across.pixels() / block, down.pixels() / block];
    // An image of one colour has no cells.
    let is_grid = block > 1 && cells.iter().any(|n| *n > 1) && cells.iter().all(|n| *n <= MAX_CELLS);
    is_grid.then_some(cells)
}

/// Returns the grid of blocks that are equal but for noise. Where neighbouring rows are equal everywhere, the other side gives the blocks' size.
fn noisy(across: &Changes, down: &Changes) -> Option<[u32; 2]> {
    let block = |changes: &Changes| Some(f64::from(changes.pixels()) / f64::from(changes.likeliest()?));
    let size = [block(across)?, block(down)?].into_iter().fold(f64::INFINITY, f64::min);
    let cells = [across, down].map(|changes| (f64::from(changes.pixels()) / size).round().max(1.0) as u32);
    let [wide, high] = [across.pixels() / cells[0].max(1), down.pixels() / cells[1].max(1)].map(f64::from);
    let is_grid = cells
        .iter()
        .zip([across, down])
        .all(|(n, changes)| *n <= MAX_CELLS && changes.at_borders(*n).is_grid());
    (is_grid && wide.max(high) <= MOST_OBLONG * wide.min(high) + 1.0).then_some(cells)
}
