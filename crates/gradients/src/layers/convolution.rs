//! Convolutions as products of matrices. Back with respect to the image: the same product with the weights transposed.

mod by_weights;

use std::sync::Arc;

use gemm::{Parallelism, gemm};

use super::depthwise::Depthwise;
use super::windows::{Weights, Windows};
use super::{Array, Back, Layer, Sums};
pub(super) use by_weights::LearntConvolution;

pub(crate) fn convolution(windows: Windows, weights: Weights) -> Box<dyn Layer> {
    let is_depthwise = weights.groups == windows.channels && weights.outputs == windows.channels;
    if is_depthwise {
        Box::new(Depthwise { windows, weights })
    } else {
        Box::new(Convolution { windows, weights })
    }
}

/// So many numbers of windows are laid out at a time: they stay in the second cache.
const LAID_OUT: usize = 1 << 16;

struct Convolution {
    windows: Windows,
    weights: Weights,
}

/// The part of a convolution that one product does: a group, and some rows of windows.
struct Tile {
    group: usize,
    rows: std::ops::Range<usize>,
}

impl Convolution {
    fn group_channels(&self) -> usize {
        self.windows.channels / self.weights.groups
    }

    fn group_outputs(&self) -> usize {
        self.weights.outputs / self.weights.groups
    }

    /// Numbers of a window, all channels of a group.
    fn inner(&self) -> usize {
        self.group_channels() * self.windows.taps()
    }

    /// Whether the image already is what the weights are multiplied with.
    fn is_pointwise(&self) -> bool {
        let w = &self.windows;
        w.taps() == 1 && w.stride == [1, 1] && w.before == [0, 0] && w.image == w.count
    }

    fn weights_of(&self, group: usize) -> Matrix<'_> {
        let size = self.group_outputs() * self.inner();
        Matrix::rows(&self.weights.weights[group * size..][..size], self.inner())
    }

    fn tiles(&self) -> impl Iterator<Item = Tile> + use<> {
        let [rows, columns] = self.windows.count;
        let at_once = if self.is_pointwise() {
            rows
        } else {
            (LAID_OUT / (self.inner() * columns)).max(1)
        };
        (0..self.weights.groups).flat_map(move |group| {
            (0..rows).step_by(at_once).map(move |first| Tile {
                group,
                rows: first..(first + at_once).min(rows),
            })
        })
    }

    /// The windows of a tile as the columns of a matrix (im2col; Chellapilla et al. 2006).
    fn lay_out(&self, image: &[f32], tile: &Tile, columns: &mut [f32]) {
        columns.fill(0.0);
        self.each_line(tile, |place, at, count| {
            self.windows.gather(&image[place..], &mut columns[at..at + count])
        });
    }

    /// The transpose of [`Convolution::lay_out`].
    fn put_back(&self, columns: &[f32], tile: &Tile, image: &mut [f32]) {
        self.each_line(tile, |place, at, count| {
            self.windows.scatter(&columns[at..at + count], &mut image[place..])
        });
    }

    /// Calls back for each line of numbers that windows beside each other have: where it begins in the image, where in the matrix,
    /// and how many there are.
    fn each_line(&self, tile: &Tile, mut line: impl FnMut(usize, usize, usize)) {
        let w = &self.windows;
        let (size, channels) = (tile.rows.len() * w.count[1], self.group_channels());
        for inner in 0..self.inner() {
            let (channel, tap) = (inner / w.taps(), inner % w.taps());
            let (down, across) = (tap / w.kernel[1], tap % w.kernel[1]);
            let (inside, place) = w.inside(1, across);
            if inside.is_empty() {
                continue;
            }
            let plane = (tile.group * channels + channel) * w.image_area();
            for (i, row) in tile.rows.clone().enumerate() {
                if let Some(y) = w.place(0, row, down) {
                    let at = inner * size + i * w.count[1] + inside.start;
                    line(plane + y * w.image[1] + place, at, inside.len());
                }
            }
        }
    }

    fn output(&self, tile: &Tile) -> usize {
        tile.group * self.group_outputs() * self.windows.area() + tile.rows.start * self.windows.count[1]
    }

    fn back(&self, gradient: &[f32], sums: &mut Sums) {
        let (w, area) = (&self.windows, self.windows.area());
        let is_new = sums.all[sums.slots[0]].is_none();
        let image = sums.sum_mut(0, w.channels * w.image_area());
        let mut columns = Vec::new();
        for tile in self.tiles() {
            let size = tile.rows.len() * w.count[1];
            let gradient = Matrix::rows(&gradient[self.output(&tile)..], area);
            let weights = self.weights_of(tile.group).transposed();
            let sides = [self.inner(), size, self.group_outputs()];
            if self.is_pointwise() {
                let plane = tile.group * self.group_channels() * area;
                multiply((&mut image[plane..], area, !is_new), weights, gradient, sides);
                continue;
            }
            columns.resize(self.inner() * size, 0.0);
            multiply((&mut columns, size, false), weights, gradient, sides);
            self.put_back(&columns, &tile, image);
        }
    }
}

impl Layer for Convolution {
    fn forward(&self, inputs: Vec<Array>, keeps: bool) -> (Array, Option<Back<'_>>) {
        let (w, area, image) = (&self.windows, self.windows.area(), &inputs[0]);
        let mut output = Vec::with_capacity(self.weights.outputs * area);
        for channel in 0..self.weights.outputs {
            output.resize((channel + 1) * area, self.weights.bias(channel));
        }
        let mut columns = Vec::new();
        for tile in self.tiles() {
            let size = tile.rows.len() * w.count[1];
            let images = if self.is_pointwise() {
                Matrix::rows(&image[tile.group * self.group_channels() * area..], area)
            } else {
                columns.resize(self.inner() * size, 0.0);
                self.lay_out(image, &tile, &mut columns);
                Matrix::rows(&columns, size)
            };
            let (at, weights) = (self.output(&tile), self.weights_of(tile.group));
            let sides = [self.group_outputs(), size, self.inner()];
            multiply((&mut output[at..], area, true), weights, images, sides);
        }
        let back = |gradient: Vec<f32>, sums: &mut Sums| self.back(&gradient, sums);
        (Arc::new(output), keeps.then(|| Box::new(back) as Back))
    }
}

/// Numbers read as a matrix: by how many numbers a row and a column lie apart.
#[derive(Clone, Copy)]
struct Matrix<'a> {
    numbers: &'a [f32],
    steps: [usize; 2],
}

impl<'a> Matrix<'a> {
    fn rows(numbers: &'a [f32], columns: usize) -> Self {
        let steps = [columns, 1];
        Matrix { numbers, steps }
    }

    fn transposed(self) -> Self {
        let steps = [self.steps[1], self.steps[0]];
        Matrix { steps, ..self }
    }

    fn holds(&self, [rows, columns]: [usize; 2]) -> bool {
        let last = (rows - 1) * self.steps[0] + (columns - 1) * self.steps[1];
        last < self.numbers.len()
    }
}

/// Adds a·b to `sum`, whose rows lie `row_step` apart, or writes it there where `sum` holds nothing yet. `sides`: the rows of a, the
/// columns of b, and the columns of a.
fn multiply(
    (sum, row_step, adds): (&mut [f32], usize, bool),
    a: Matrix,
    b: Matrix,
    [rows, columns, inner]: [usize; 3],
) {
    if rows == 0 || columns == 0 || inner == 0 {
        return;
    }
    let to = Matrix::rows(sum, row_step);
    assert!(row_step >= columns && to.holds([rows, columns]) && a.holds([rows, inner]) && b.holds([inner, columns]));
    let [a_steps, b_steps] = [a, b].map(|m| m.steps.map(|step| step as isize));
    // SAFETY: the largest index of each matrix was held against its length, and rows of `sum` do not overlap.
    unsafe {
        gemm(
            rows,
            columns,
            inner,
            sum.as_mut_ptr(),
            1,
            row_step as isize,
            adds,
            a.numbers.as_ptr(),
            a_steps[1],
            a_steps[0],
            b.numbers.as_ptr(),
            b_steps[1],
            b_steps[0],
            1.0,
            1.0,
            false,
            false,
            false,
            Parallelism::None,
        );
    }
}
