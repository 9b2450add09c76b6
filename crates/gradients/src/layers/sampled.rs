//! Images looked at between their pixels.

use std::sync::Arc;

use super::{Array, Back, Layer, Number, Sums};

/// Images and places in, the images' colours at these places out, weighted between the four pixels around (ONNX: GridSample, bilinear).
pub struct Sampled {
    pub images: usize,
    pub channels: usize,
    /// Rows and columns of an image.
    pub image: [usize; 2],
    /// Places looked at in each image, each written as x and y: −1 and 1 are the borders.
    pub places: usize,
    /// True where these are the middles of the outermost pixels and not their outer edges.
    pub aligns_corners: bool,
    /// True where the border goes on outside, where otherwise everything is 0.
    pub clamps: bool,
}

/// A place between the pixels of a plane: of the pixel left above it and of those on the right, below and right below, which one it is,
/// if it is in the image; and the place's distances from the first.
struct Between<T> {
    pixels: [Option<usize>; 4],
    shares: [T; 2],
    /// d pixel / d place, across and down.
    slopes: [T; 2],
}

impl<T: Number> Between<T> {
    fn weights(&self) -> [T; 4] {
        let [x, y] = self.shares;
        let (left, above) = (T::ONE - x, T::ONE - y);
        [left * above, x * above, left * y, x * y]
    }

    /// Returns by how much each pixel's weight grows with the place, across and down.
    fn growths(&self) -> [[T; 2]; 4] {
        let [x, y] = self.shares;
        let (left, above) = (T::ONE - x, T::ONE - y);
        [[-above, -left], [above, -x], [-y, left], [y, x]]
    }
}

impl Sampled {
    fn between<T: Number>(&self, place: &[T]) -> Between<T> {
        let along = |axis: usize| {
            let (side, v) = (self.image[1 - axis] as f64, place[axis].wide());
            let (at, slope) = if self.aligns_corners {
                ((v + 1.0) * ((side - 1.0) / 2.0), (side - 1.0) / 2.0)
            } else {
                (((v + 1.0) * side - 1.0) / 2.0, side / 2.0)
            };
            let inside = at.clamp(0.0, side - 1.0);
            if self.clamps && inside != at {
                (inside, 0.0)
            } else {
                (at, slope)
            }
        };
        let [(x, x_slope), (y, y_slope)] = [along(0), along(1)];
        let pixel = |[right, down]: [f64; 2]| {
            let (column, row) = (x.floor() + right, y.floor() + down);
            let is_inside = (0.0..self.image[1] as f64).contains(&column) && (0.0..self.image[0] as f64).contains(&row);
            is_inside.then(|| row as usize * self.image[1] + column as usize)
        };
        Between {
            pixels: [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]].map(pixel),
            shares: [T::of(x - x.floor()), T::of(y - y.floor())],
            slopes: [T::of(x_slope), T::of(y_slope)],
        }
    }

    /// Calls back for each place of each image: with its number, and where its first channel begins in the images and in the output.
    fn each<T: Number>(&self, grid: &[T], mut look: impl FnMut(usize, Between<T>, [usize; 2])) {
        for (i, place) in grid.chunks_exact(2).enumerate() {
            let (image, at) = (i / self.places, i % self.places);
            let first = image * self.channels;
            look(i, self.between(place), [first * self.area(), first * self.places + at]);
        }
    }

    fn area(&self) -> usize {
        self.image[0] * self.image[1]
    }

    fn back<T: Number>(&self, gradient: &[T], images: &[T], grid: &[T], sums: &mut Sums<T>) {
        let mut by_place = vec![T::ZERO; grid.len()];
        let by_image = sums.sum_mut(0, images.len());
        self.each(grid, |i, between, [image, output]| {
            let (weights, growths) = (between.weights(), between.growths());
            for channel in 0..self.channels {
                let g = gradient[output + channel * self.places];
                if g == T::ZERO {
                    continue;
                }
                for (corner, pixel) in between.pixels.iter().enumerate() {
                    if let Some(pixel) = pixel {
                        let at = image + channel * self.area() + pixel;
                        by_image[at] += g * weights[corner];
                        let colour = g * images[at];
                        (0..2).for_each(|k| by_place[2 * i + k] += colour * growths[corner][k] * between.slopes[k]);
                    }
                }
            }
        });
        sums.add(1, by_place);
    }
}

impl<T: Number> Layer<T> for Sampled {
    fn forward(&self, inputs: Vec<Array<T>>, keeps: bool) -> (Array<T>, Option<Back<'_, T>>) {
        let (images, grid) = (inputs[0].clone(), inputs[1].clone());
        let mut output = vec![T::ZERO; self.images * self.channels * self.places];
        self.each(&grid, |_, between, [image, at]| {
            let weights = between.weights();
            for channel in 0..self.channels {
                let plane = &images[image + channel * self.area()..];
                let corners = between.pixels.iter().zip(weights);
                let sum = corners
                    .filter_map(|(pixel, weight)| Some(plane[(*pixel)?] * weight))
                    .sum();
                output[at + channel * self.places] = sum;
            }
        });
        let back = move |gradient: Vec<T>, sums: &mut Sums<T>| self.back(&gradient, &images, &grid, sums);
        (Arc::new(output), keeps.then(|| Box::new(back) as Back<T>))
    }
}
