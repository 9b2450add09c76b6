//! Computation of pixels from coefficients, at full size or reduced by 2, 4 or 8.

use std::ops::Range;

use image::metadata::Orientation;
use image::{GrayImage, RgbImage};

use super::coefficients::Component;
use super::colour;
use super::frame::Colours;
use super::inverse_dct::{Transform, to_u8};
use super::read::Coefficients;
use super::upsample;

/// Factors by which a JPEG can be decoded reduced: its blocks of 8 × 8 pixels become 1 × 1, 2 × 2 or 4 × 4.
pub const REDUCTIONS: [u32; 3] = [8, 4, 2];

impl Coefficients {
    /// Returns the first component upright, at 1/`reduction` of the size (1, 2, 4 or 8); a remainder at the right and at the bottom is left out.
    pub(crate) fn luma(&self, reduction: u32, orientation: Orientation) -> GrayImage {
        let mut canvas = Canvas::new(orientation, self.size.map(|side| (side / reduction) as usize));
        self.rows(
            &self.components[..1],
            reduction,
            |_| true,
            |y, width, rows| {
                canvas.fill(y, width, |row| row.copy_from_slice(&rows[0][..width]));
            },
        );
        let [width, height] = canvas.upright;
        GrayImage::from_raw(width as u32, height as u32, canvas.pixels).unwrap_or_default()
    }

    /// Returns the first component's pixels in an area of the upright image, at full size; `None` if it has fewer samples than pixels.
    pub(crate) fn luma_part(&self, start: [u32; 2], size: [u32; 2], orientation: Orientation) -> Option<GrayImage> {
        let component = &self.components[0];
        if component.sampling != self.most_sampling {
            return None;
        }
        let (swaps, from_end) = flips(orientation);
        // The area in the stored image: in its order of axes, counted from its first pixel.
        let swapped = |[a, b]: [usize; 2]| if swaps { [b, a] } else { [a, b] };
        let [start, size, image] = [start, size, self.size].map(|pair| pair.map(|v| v as usize));
        let upright = swapped(image);
        let end = [0, 1].map(|i| upright[i] - start[i] - size[i]);
        let start = swapped([0, 1].map(|i| if from_end[i] { end[i] } else { start[i] }));
        let size = swapped(size);
        let mut canvas = Canvas::new(orientation, size);
        let transform = Transform::<64>::new([8, 8], component);
        let [columns, rows] = [0, 1].map(|i| start[i] / 8..(start[i] + size[i]).div_ceil(8));
        let mut strip = vec![0; 64 * columns.len()];
        for row in rows {
            let first = row * component.blocks[0];
            transform.fill(component, first + columns.start..first + columns.end, &mut strip);
            for (y, line) in (8 * row..).zip(strip.chunks_exact(8 * columns.len())) {
                if (start[1]..start[1] + size[1]).contains(&y) {
                    let part = &line[start[0] - 8 * columns.start..][..size[0]];
                    canvas.fill(y - start[1], size[0], |row| row.copy_from_slice(part));
                }
            }
        }
        let [width, height] = canvas.upright;
        GrayImage::from_raw(width as u32, height as u32, canvas.pixels)
    }

    /// Returns the colours upright, at 1/`reduction` of the size; a remainder is left out.
    pub(crate) fn rgb(&self, reduction: u32, orientation: Orientation) -> RgbImage {
        let mut canvas = Canvas::new(orientation, self.size.map(|side| (side / reduction) as usize));
        self.rows(
            &self.components,
            reduction,
            |_| true,
            |y, width, rows| {
                canvas.fill(y, width, |row| self.colours_of(rows, row));
            },
        );
        let [width, height] = canvas.upright;
        RgbImage::from_raw(width as u32, height as u32, canvas.pixels.into_flattened()).unwrap_or_default()
    }

    /// Returns the colours of the requested rows, one after the other, at full size and unrotated.
    pub(crate) fn rgb_rows(&self, wants: impl Fn(usize) -> bool) -> Vec<u8> {
        let mut pixels: Vec<[u8; 3]> = Vec::new();
        self.rows(&self.components, 1, wants, |_, width, rows| {
            let start = pixels.len();
            pixels.resize(start + width, [0; 3]);
            self.colours_of(rows, &mut pixels[start..]);
        });
        pixels.into_flattened()
    }

    fn colours_of(&self, rows: &[&[u8]], to: &mut [[u8; 3]]) {
        match (self.colours, rows) {
            (Colours::YCbCr, [y, cb, cr]) => colour::from_ycbcr([y, cb, cr], to),
            (Colours::Rgb, [r, g, b]) => colour::together([r, g, b], to),
            (Colours::Cmyk, [c, m, y, k]) => colour::from_cmyk([c, m, y], k, to),
            (Colours::Ycck, [y, cb, cr, k]) => colour::from_ycck([y, cb, cr], k, to),
            (_, rows) => colour::together([rows[0]; 3], to),
        }
    }

    /// Calls `with` for each requested row of the image: its index, its width, and a slice for each of the components.
    fn rows(
        &self,
        components: &[Component],
        reduction: u32,
        wants: impl Fn(usize) -> bool,
        mut with: impl FnMut(usize, usize, &[&[u8]]),
    ) {
        let [width, height] = self.size.map(|side| (side / reduction) as usize);
        let group_height = (8 / reduction * self.most_sampling[1]) as usize;
        let plane = |component| Plane::new(component, self.most_sampling, 8 / reduction);
        let mut planes: Vec<Plane> = components.iter().map(plane).collect();
        for y in 0..height {
            // The group of rows below is read too, since rows in between need both.
            if y.is_multiple_of(group_height) {
                let group = y / group_height;
                for plane in &mut planes {
                    if group == 0 {
                        plane.read(0);
                    }
                    plane.read(group + 1);
                }
            }
            if !wants(y) {
                continue;
            }
            let rows: Vec<&[u8]> = planes.iter_mut().map(|plane| plane.row(y)).collect();
            with(y, width, &rows);
        }
    }
}

/// Upright image, filled by rows as they are stored.
struct Canvas<P> {
    pixels: Vec<P>,
    upright: [usize; 2],
    /// Index of the first stored pixel.
    start: isize,
    /// Index steps from a stored pixel to the next one across and down.
    step: [isize; 2],
    /// Buffer for a stored row that must be rotated.
    row: Vec<P>,
}

impl<P: Copy + Default> Canvas<P> {
    fn new(orientation: Orientation, [width, height]: [usize; 2]) -> Canvas<P> {
        let (swaps, from_end) = flips(orientation);
        let upright = if swaps { [height, width] } else { [width, height] };
        let steps = [1, upright[0] as isize];
        let ends = [0, 1].map(|i| (upright[i] as isize - 1) * steps[i]);
        let steps = [0, 1].map(|i| if from_end[i] { -steps[i] } else { steps[i] });
        Canvas {
            pixels: vec![P::default(); width * height],
            upright,
            start: (0..2).filter(|i| from_end[*i]).map(|i| ends[i]).sum(),
            step: if swaps { [steps[1], steps[0]] } else { steps },
            row: Vec::new(),
        }
    }

    /// Lets `make` write a stored row, in place if it is not rotated.
    fn fill(&mut self, y: usize, width: usize, make: impl FnOnce(&mut [P])) {
        let first = self.start + y as isize * self.step[1];
        if self.step[0] == 1 {
            return make(&mut self.pixels[first as usize..][..width]);
        }
        self.row.resize(width, P::default());
        make(&mut self.row);
        for (x, pixel) in self.row.iter().enumerate() {
            self.pixels[(first + x as isize * self.step[0]) as usize] = *pixel;
        }
    }
}

/// Returns the flips that make a stored image upright, by EXIF (2.32, 4.6.4: Orientation): whether its sides are swapped, and then whether columns
/// and rows count from the right and from the bottom.
fn flips(orientation: Orientation) -> (bool, [bool; 2]) {
    match orientation {
        Orientation::NoTransforms => (false, [false, false]),
        Orientation::FlipHorizontal => (false, [true, false]),
        Orientation::Rotate180 => (false, [true, true]),
        Orientation::FlipVertical => (false, [false, true]),
        Orientation::Rotate90FlipH => (true, [false, false]),
        Orientation::Rotate90 => (true, [true, false]),
        Orientation::Rotate270FlipH => (true, [true, true]),
        Orientation::Rotate270 => (true, [false, true]),
    }
}

/// Samples of one component; three groups of rows are kept.
struct Plane<'a> {
    component: &'a Component,
    transform: Box<dyn Fill>,
    /// Number of samples across and down of a block.
    block: [usize; 2],
    /// Number of the image's pixels per sample, across and down.
    enlarged: [usize; 2],
    /// Number of samples that the image covers.
    size: [usize; 2],
    /// Ring buffer of three groups of rows.
    kept: Vec<u8>,
    enlarged_row: Vec<u8>,
    sums: Vec<u16>,
}

impl<'a> Plane<'a> {
    /// Creates the plane for `n` pixels per eight of a block. A component with fewer samples is reduced less, if possible.
    fn new(component: &'a Component, most_sampling: [u32; 2], n: u32) -> Plane<'a> {
        let mut block = [n as usize; 2];
        let mut enlarged = [0, 1].map(|i| (most_sampling[i] / component.sampling[i]).max(1) as usize);
        for (n, enlarged) in block.iter_mut().zip(&mut enlarged) {
            while *n < 8 && enlarged.is_multiple_of(2) {
                *n *= 2;
                *enlarged /= 2;
            }
        }
        let transform: Box<dyn Fill> = match block[0] * block[1] {
            1 => Box::new(Transform::<1>::new(block, component)),
            2 => Box::new(Transform::<2>::new(block, component)),
            4 => Box::new(Transform::<4>::new(block, component)),
            8 => Box::new(Transform::<8>::new(block, component)),
            16 => Box::new(Transform::<16>::new(block, component)),
            32 => Box::new(Transform::<32>::new(block, component)),
            _ => Box::new(Transform::<64>::new(block, component)),
        };
        let group = component.sampling[1] as usize * block[1];
        let stride = component.blocks[0] * block[0];
        Plane {
            size: [0, 1].map(|i| (component.size[i] * block[i]).div_ceil(8)),
            kept: vec![0; 3 * group * stride],
            enlarged_row: vec![0; stride * enlarged[0]],
            sums: Vec::new(),
            component,
            transform,
            block,
            enlarged,
        }
    }

    fn stride(&self) -> usize {
        self.component.blocks[0] * self.block[0]
    }

    /// Returns the number of rows of blocks in a group.
    fn blocks_down(&self) -> usize {
        self.component.sampling[1] as usize
    }

    /// Computes the samples of a group of rows, if it exists.
    fn read(&mut self, group: usize) {
        let (down, stride) = (self.blocks_down(), self.stride());
        for row in 0..down {
            let block_row = group * down + row;
            if block_row >= self.component.blocks[1] {
                return;
            }
            let start = (group % 3 * down + row) * self.block[1] * stride;
            let to = &mut self.kept[start..][..self.block[1] * stride];
            let blocks = block_row * self.component.blocks[0]..(block_row + 1) * self.component.blocks[0];
            self.transform.fill(self.component, blocks, to);
        }
    }

    /// Returns a row of the image, from samples that are kept.
    fn row(&mut self, y: usize) -> &[u8] {
        let ([width, height], [across, down]) = (self.size, self.enlarged);
        let (stride, rows) = (self.stride(), 3 * self.blocks_down() * self.block[1]);
        let row = |y: usize| &self.kept[y % rows * stride..][..width];
        let near = (y / down).min(height - 1);
        // The adjacent row on the side of this pixel row.
        let is_upper = y.is_multiple_of(down);
        let far = if is_upper {
            near.saturating_sub(1)
        } else {
            (near + 1).min(height - 1)
        };
        let to = self.enlarged_row.as_mut_slice();
        match (across, down) {
            (1, 1) => return row(near),
            (2, 1) if width > 2 => upsample::across(row(near), to),
            (2, 2) if width > 2 => upsample::both([row(near), row(far)], &mut self.sums, to),
            (1, 2) => upsample::down([row(near), row(far)], y.is_multiple_of(2), to),
            _ => upsample::repeated(row(near), across, to),
        }
        to
    }
}

/// Computation of samples for any size of block.
trait Fill {
    /// Writes the samples of adjacent blocks, row by row.
    fn fill(&self, component: &Component, blocks: Range<usize>, to: &mut [u8]);
}

impl<const N: usize> Fill for Transform<N> {
    fn fill(&self, component: &Component, blocks: Range<usize>, to: &mut [u8]) {
        fill(self, component, blocks, to);
    }
}

scaleproof_core::by_avx2! {
    fn fill[const N: usize](transform: &Transform<N>, component: &Component, blocks: Range<usize>, to: &mut [u8]) {
        match transform.across {
            8 => fill_across::<N, 8>(transform, component, blocks, to),
            4 => fill_across::<N, 4>(transform, component, blocks, to),
            2 => fill_across::<N, 2>(transform, component, blocks, to),
            _ => fill_across::<N, 1>(transform, component, blocks, to),
        }
    }
}

/// Fills rows with a width known at compile time, so that copies of a row are single instructions.
#[inline(always)]
fn fill_across<const N: usize, const ACROSS: usize>(
    transform: &Transform<N>,
    component: &Component,
    blocks: Range<usize>,
    to: &mut [u8],
) {
    let stride = blocks.len() * ACROSS;
    let (mut values, mut samples) = ([[0.0; N]; AT_ONCE], [[0; N]; AT_ONCE]);
    for first in (0..blocks.len()).step_by(AT_ONCE) {
        let count = AT_ONCE.min(blocks.len() - first);
        for (block, values) in (blocks.start + first..).zip(&mut values[..count]) {
            *values = transform.samples(component, block);
        }
        for (sample, value) in samples.as_flattened_mut().iter_mut().zip(values.as_flattened()) {
            *sample = to_u8(*value);
        }
        for (column, samples) in (first..).zip(&samples[..count]) {
            for (row, samples) in samples.as_chunks::<ACROSS>().0.iter().enumerate() {
                to[row * stride + column * ACROSS..][..ACROSS].copy_from_slice(samples);
            }
        }
    }
}

/// Number of blocks whose samples are rounded in one loop, which the compiler vectorises.
const AT_ONCE: usize = 16;
