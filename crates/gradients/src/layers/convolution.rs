//! Convolutions as products of matrices. Back with respect to the image: the same product with the weights transposed.

use std::sync::Arc;

use super::depthwise::Depthwise;
use super::matrix::{Matrix, multiply};
use super::windows::{Weights, Windows};
use super::{Array, Back, Layer, Number, Sums};

pub fn convolution<T: Number>(windows: Windows, weights: Weights<T>) -> Box<dyn Layer<T>> {
    let is_depthwise = weights.groups == windows.channels && weights.outputs == windows.channels;
    if is_depthwise {
        Box::new(Depthwise { windows, weights })
    } else {
        Box::new(Convolution { windows, weights })
    }
}

/// Numbers of windows that are laid out at a time: they stay in the second cache.
const LAID_OUT: usize = 1 << 16;

pub(super) struct Convolution<T> {
    pub windows: Windows,
    pub weights: Weights<T>,
}

/// The part of a convolution that one product does: a group, and some rows of windows.
pub(super) struct Tile {
    pub group: usize,
    pub rows: std::ops::Range<usize>,
}

impl<T: Number> Convolution<T> {
    fn group_channels(&self) -> usize {
        self.windows.channels / self.weights.groups
    }

    pub(super) fn group_outputs(&self) -> usize {
        self.weights.outputs / self.weights.groups
    }

    /// Numbers of a window, all channels of a group.
    pub(super) fn inner(&self) -> usize {
        self.group_channels() * self.windows.taps()
    }

    /// Returns whether the image already is what the weights are multiplied with.
    fn is_pointwise(&self) -> bool {
        let w = &self.windows;
        w.taps() == 1 && w.stride == [1, 1] && w.before == [0, 0] && w.image == w.count
    }

    fn weights_of(&self, group: usize) -> Matrix<'_, T> {
        let size = self.group_outputs() * self.inner();
        Matrix::rows(&self.weights.weights[group * size..][..size], self.inner())
    }

    pub(super) fn tiles(&self) -> impl Iterator<Item = Tile> + use<T> {
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
    fn lay_out(&self, image: &[T], tile: &Tile, columns: &mut [T]) {
        columns.fill(T::ZERO);
        self.each_line(tile, |place, at, count| {
            self.windows.gather(&image[place..], &mut columns[at..at + count])
        });
    }

    /// The windows of a tile as a matrix of one window a column: the image itself where that is it, else laid out in `columns`.
    pub(super) fn windows_of<'a>(&self, image: &'a [T], tile: &Tile, columns: &'a mut Vec<T>) -> Matrix<'a, T> {
        if self.is_pointwise() {
            let area = self.windows.area();
            return Matrix::rows(&image[tile.group * self.group_channels() * area..], area);
        }
        let size = tile.rows.len() * self.windows.count[1];
        columns.resize(self.inner() * size, T::ZERO);
        self.lay_out(image, tile, columns);
        Matrix::rows(columns, size)
    }

    /// The transpose of [`Convolution::lay_out`].
    fn put_back(&self, columns: &[T], tile: &Tile, image: &mut [T]) {
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

    pub(super) fn output(&self, tile: &Tile) -> usize {
        tile.group * self.group_outputs() * self.windows.area() + tile.rows.start * self.windows.count[1]
    }

    /// Adds to an image, or to one of zeros, what derivatives by the windows' sums are worth there.
    pub(super) fn spread(&self, gradient: &[T], image: &mut [T], is_zero: bool) {
        let (w, area) = (&self.windows, self.windows.area());
        let mut columns = Vec::new();
        for tile in self.tiles() {
            let size = tile.rows.len() * w.count[1];
            let gradient = Matrix::rows(&gradient[self.output(&tile)..], area);
            let weights = self.weights_of(tile.group).transposed();
            let sides = [self.inner(), size, self.group_outputs()];
            if self.is_pointwise() {
                let plane = tile.group * self.group_channels() * area;
                multiply((&mut image[plane..], area, !is_zero), weights, gradient, sides);
                continue;
            }
            columns.resize(self.inner() * size, T::ZERO);
            multiply((&mut columns, size, false), weights, gradient, sides);
            self.put_back(&columns, &tile, image);
        }
    }

    /// Adds the windows' sums to an output.
    pub(super) fn gather(&self, image: &[T], output: &mut [T]) {
        let (w, area) = (&self.windows, self.windows.area());
        let mut columns = Vec::new();
        for tile in self.tiles() {
            let size = tile.rows.len() * w.count[1];
            let images = self.windows_of(image, &tile, &mut columns);
            let (at, weights) = (self.output(&tile), self.weights_of(tile.group));
            let sides = [self.group_outputs(), size, self.inner()];
            multiply((&mut output[at..], area, true), weights, images, sides);
        }
    }
}

impl<T: Number> Layer<T> for Convolution<T> {
    fn forward(&self, inputs: Vec<Array<T>>, keeps: bool) -> (Array<T>, Option<Back<'_, T>>) {
        let mut output = self.weights.biases_each(self.windows.area());
        self.gather(&inputs[0], &mut output);
        let back = |gradient: Vec<T>, sums: &mut Sums<T>| {
            let is_zero = sums.all[sums.slots[0]].is_none();
            let image = sums.sum_mut(0, self.windows.channels * self.windows.image_area());
            self.spread(&gradient, image, is_zero);
        };
        (Arc::new(output), keeps.then(|| Box::new(back) as Back<T>))
    }
}
