//! Pixels of coefficients, at full size or reduced by 2, 4 or 8.

use std::ops::Range;

use image::metadata::Orientation;
use image::{GrayImage, RgbImage};

use super::coefficients::Component;
use super::colour;
use super::frame::Colours;
use super::inverse_dct::Transform;
use super::read::Coefficients;
use super::upsample;

impl Coefficients {
    /// The first component upright, at 1/`reduction` of the size (1, 2, 4 or 8); a rest at the right and at the bottom is left out.
    pub(in crate::photo) fn luma(&self, reduction: u32, orientation: Orientation) -> GrayImage {
        let mut canvas = self.canvas(reduction, orientation);
        self.rows(&self.components[..1], reduction, |y, width, rows| {
            canvas.put(y, &rows[0][..width]);
        });
        let [width, height] = canvas.turn.upright;
        GrayImage::from_raw(width as u32, height as u32, canvas.pixels).unwrap_or_default()
    }

    /// The first component's pixels of an area of the upright image, at full size; `None` where it has fewer samples than pixels.
    pub(in crate::photo) fn luma_part(
        &self,
        start: [u32; 2],
        size: [u32; 2],
        orientation: Orientation,
    ) -> Option<GrayImage> {
        let component = &self.components[0];
        if component.sampling != self.most_sampling {
            return None;
        }
        let flips = Flips::of(orientation);
        let (start, size) = flips.stored(
            start.map(|v| v as usize),
            size.map(|v| v as usize),
            self.size.map(|v| v as usize),
        );
        let mut canvas = Canvas {
            pixels: vec![0; size[0] * size[1]],
            turn: Turn::new(&flips, size),
        };
        let transform = Transform::<64>::new([8, 8], component);
        let [columns, rows] = [0, 1].map(|i| start[i] / 8..(start[i] + size[i]).div_ceil(8));
        let mut strip = vec![0; 64 * columns.len()];
        let stride = 8 * columns.len();
        for row in rows {
            let first = row * component.blocks[0];
            samples(
                &transform,
                component,
                first + columns.start..first + columns.end,
                8,
                &mut strip,
            );
            for (y, line) in (8 * row..).zip(strip.chunks_exact(stride)) {
                if (start[1]..start[1] + size[1]).contains(&y) {
                    canvas.put(y - start[1], &line[start[0] - 8 * columns.start..][..size[0]]);
                }
            }
        }
        let [width, height] = canvas.turn.upright;
        GrayImage::from_raw(width as u32, height as u32, canvas.pixels)
    }

    /// Colours upright, at 1/`reduction` of the size; a rest is left out.
    pub(in crate::photo) fn rgb(&self, reduction: u32, orientation: Orientation) -> RgbImage {
        let mut canvas = self.canvas(reduction, orientation);
        let mut row = Vec::new();
        self.rows(&self.components, reduction, |y, width, rows| {
            row.resize(width, [0; 3]);
            match (self.colours, rows) {
                (Colours::YCbCr, [y, cb, cr]) => colour::from_ycbcr([y, cb, cr], &mut row),
                (Colours::Rgb, [r, g, b]) => colour::together([r, g, b], &mut row),
                (Colours::Cmyk, [c, m, y, k]) => colour::from_cmyk([c, m, y], k, &mut row),
                (Colours::Ycck, [y, cb, cr, k]) => colour::from_ycck([y, cb, cr], k, &mut row),
                (_, rows) => colour::together([rows[0]; 3], &mut row),
            }
            canvas.put(y, &row);
        });
        let [width, height] = canvas.turn.upright;
        RgbImage::from_raw(width as u32, height as u32, canvas.pixels.into_flattened()).unwrap_or_default()
    }

    fn canvas<P: Copy + Default>(&self, reduction: u32, orientation: Orientation) -> Canvas<P> {
        let [width, height] = self.size.map(|side| (side / reduction) as usize);
        Canvas {
            pixels: vec![P::default(); width * height],
            turn: Turn::new(&Flips::of(orientation), [width, height]),
        }
    }

    /// Calls with the place of each row of the image, its width, and a slice for each of the components.
    fn rows(&self, components: &[Component], reduction: u32, mut with: impl FnMut(usize, usize, &[&[u8]])) {
        let [width, height] = self.size.map(|side| (side / reduction) as usize);
        let across = self.most_sampling.map(|most| (8 / reduction * most) as usize);
        let mut planes: Vec<Plane> = components
            .iter()
            .map(|c| Plane::of(c, self.most_sampling, 8 / reduction))
            .collect();
        let mut buffers: Vec<Buffer> = planes.iter().map(Plane::buffer).collect();
        for y in 0..height {
            // The group of rows below is there too, since rows between two are made of both.
            if y.is_multiple_of(across[1]) {
                let group = y / across[1];
                for plane in &mut planes {
                    if group == 0 {
                        plane.read(0);
                    }
                    plane.read(group + 1);
                }
            }
            let rows = planes
                .iter()
                .zip(&mut buffers)
                .map(|(plane, buffer)| plane.row(y, buffer));
            with(y, width, &rows.collect::<Vec<&[u8]>>());
        }
    }
}

/// An upright image that is filled by rows as they are stored.
struct Canvas<P> {
    pixels: Vec<P>,
    turn: Turn,
}

impl<P: Copy> Canvas<P> {
    fn put(&mut self, y: usize, row: &[P]) {
        let Turn { start, step, .. } = self.turn;
        let first = start + y as isize * step[1];
        if step[0] == 1 {
            self.pixels[first as usize..][..row.len()].copy_from_slice(row);
            return;
        }
        for (x, pixel) in row.iter().enumerate() {
            self.pixels[(first + x as isize * step[0]) as usize] = *pixel;
        }
    }
}

/// Where stored pixels lie in the upright image.
struct Turn {
    /// Width and height of the upright image.
    upright: [usize; 2],
    /// The place of the first stored pixel.
    start: isize,
    /// From a pixel to the next one across and down.
    step: [isize; 2],
}

impl Turn {
    /// Of a stored image of a width and height.
    fn new(flips: &Flips, [width, height]: [usize; 2]) -> Turn {
        let Flips {
            swaps,
            from_right,
            from_bottom,
        } = *flips;
        let upright = if swaps { [height, width] } else { [width, height] };
        let (across, down) = (1, upright[0] as isize);
        let right = if from_right { upright[0] as isize - 1 } else { 0 };
        let bottom = if from_bottom { upright[1] as isize - 1 } else { 0 };
        let steps = [
            if from_right { -across } else { across },
            if from_bottom { -down } else { down },
        ];
        Turn {
            upright,
            start: right + bottom * down,
            step: if swaps { [steps[1], steps[0]] } else { steps },
        }
    }
}

/// How a stored image is made upright: its sides are swapped, and then counted from the other end.
struct Flips {
    swaps: bool,
    from_right: bool,
    from_bottom: bool,
}

impl Flips {
    /// By EXIF (2.32, 4.6.4: Orientation).
    fn of(orientation: Orientation) -> Flips {
        use Orientation::*;
        let (swaps, from_right, from_bottom) = match orientation {
            NoTransforms => (false, false, false),
            FlipHorizontal => (false, true, false),
            Rotate180 => (false, true, true),
            FlipVertical => (false, false, true),
            Rotate90FlipH => (true, false, false),
            Rotate90 => (true, true, false),
            Rotate270FlipH => (true, true, true),
            Rotate270 => (true, false, true),
        };
        Flips {
            swaps,
            from_right,
            from_bottom,
        }
    }

    /// Where an area of the upright image is stored: its first pixel and size. `image`: the size of all, as stored.
    fn stored(&self, start: [usize; 2], size: [usize; 2], image: [usize; 2]) -> ([usize; 2], [usize; 2]) {
        let swapped = |[a, b]: [usize; 2]| if self.swaps { [b, a] } else { [a, b] };
        let upright = swapped(image);
        let from_end = [self.from_right, self.from_bottom];
        let start = [0, 1].map(|i| {
            if from_end[i] {
                upright[i] - start[i] - size[i]
            } else {
                start[i]
            }
        });
        (swapped(start), swapped(size))
    }
}

/// One component's samples, of which three groups of rows are kept.
struct Plane<'a> {
    component: &'a Component,
    transform: Whichever,
    /// Samples across and down of a block.
    block: [usize; 2],
    /// How many pixels of the image a sample covers across and down.
    enlarged: [usize; 2],
    /// Samples that the image covers.
    size: [usize; 2],
    /// Three groups of rows in turn.
    kept: Vec<u8>,
}

/// Where a row is enlarged.
struct Buffer {
    row: Vec<u8>,
    sums: Vec<u16>,
}

/// By the number of samples of a block.
enum Whichever {
    S1(Transform<1>),
    S2(Transform<2>),
    S4(Transform<4>),
    S8(Transform<8>),
    S16(Transform<16>),
    S32(Transform<32>),
    S64(Transform<64>),
}

impl<'a> Plane<'a> {
    /// For pictures that make `n` pixels of the eight of a block. A component with fewer samples is reduced less, where that serves.
    fn of(component: &'a Component, most_sampling: [u32; 2], n: u32) -> Plane<'a> {
        let mut block = [n as usize; 2];
        let mut enlarged = [0, 1].map(|i| (most_sampling[i] / component.sampling[i]).max(1) as usize);
        for (n, enlarged) in block.iter_mut().zip(&mut enlarged) {
            while *n < 8 && enlarged.is_multiple_of(2) {
                *n *= 2;
                *enlarged /= 2;
            }
        }
        let transform = match block[0] * block[1] {
            1 => Whichever::S1(Transform::new(block, component)),
            2 => Whichever::S2(Transform::new(block, component)),
            4 => Whichever::S4(Transform::new(block, component)),
            8 => Whichever::S8(Transform::new(block, component)),
            16 => Whichever::S16(Transform::new(block, component)),
            32 => Whichever::S32(Transform::new(block, component)),
            _ => Whichever::S64(Transform::new(block, component)),
        };
        let group = component.sampling[1] as usize * block[1];
        Plane {
            size: [0, 1].map(|i| (component.size[i] * block[i]).div_ceil(8)),
            kept: vec![0; 3 * group * component.blocks[0] * block[0]],
            component,
            transform,
            block,
            enlarged,
        }
    }

    fn stride(&self) -> usize {
        self.component.blocks[0] * self.block[0]
    }

    fn buffer(&self) -> Buffer {
        Buffer {
            row: vec![0; self.stride() * self.enlarged[0]],
            sums: Vec::new(),
        }
    }

    /// Rows of blocks in a group.
    fn blocks_down(&self) -> usize {
        self.component.sampling[1] as usize
    }

    /// Makes the samples of a group of rows, if there is such a group.
    fn read(&mut self, group: usize) {
        let (down, stride) = (self.blocks_down(), self.stride());
        for row in 0..down {
            let block_row = group * down + row;
            if block_row >= self.component.blocks[1] {
                return;
            }
            let start = (group % 3 * down + row) * self.block[1] * stride;
            let to = &mut self.kept[start..][..self.block[1] * stride];
            let (c, across) = (self.component, self.block[0]);
            let blocks = block_row * c.blocks[0]..(block_row + 1) * c.blocks[0];
            match &self.transform {
                Whichever::S1(t) => samples(t, c, blocks, across, to),
                Whichever::S2(t) => samples(t, c, blocks, across, to),
                Whichever::S4(t) => samples(t, c, blocks, across, to),
                Whichever::S8(t) => samples(t, c, blocks, across, to),
                Whichever::S16(t) => samples(t, c, blocks, across, to),
                Whichever::S32(t) => samples(t, c, blocks, across, to),
                Whichever::S64(t) => samples(t, c, blocks, across, to),
            }
        }
    }

    /// A row of the image, of samples that are kept.
    fn row<'b>(&'b self, y: usize, buffer: &'b mut Buffer) -> &'b [u8] {
        let [width, height] = self.size;
        let stride = self.stride();
        let rows = 3 * self.blocks_down() * self.block[1];
        let row = |y: usize| &self.kept[y % rows * stride..][..width];
        let [across, down] = self.enlarged;
        let near = (y / down).min(height - 1);
        // The row on the other side of the middle of the near one.
        let far = if y.is_multiple_of(down) {
            near.saturating_sub(1)
        } else {
            (near + 1).min(height - 1)
        };
        let to = buffer.row.as_mut_slice();
        match (across, down) {
            (1, 1) => return row(near),
            (2, 1) if width > 2 => upsample::across(row(near), to),
            (2, 2) if width > 2 => upsample::both([row(near), row(far)], &mut buffer.sums, to),
            (1, 2) => upsample::down([row(near), row(far)], y.is_multiple_of(2), to),
            _ => upsample::repeated(row(near), across, to),
        }
        &buffer.row
    }
}

/// The samples of neighbouring blocks, each with so many across.
fn samples<const N: usize>(
    transform: &Transform<N>,
    component: &Component,
    blocks: Range<usize>,
    across: usize,
    to: &mut [u8],
) {
    #[cfg(target_arch = "x86_64")]
    if std::is_x86_feature_detected!("avx2") {
        // SAFETY: the processor has the instructions.
        return unsafe { samples_avx2(transform, component, blocks, across, to) };
    }
    samples_by(transform, component, blocks, across, to);
}

/// [`samples_by`] compiled for AVX2, to bit-identical results: nothing is contracted or reordered.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn samples_avx2<const N: usize>(
    transform: &Transform<N>,
    component: &Component,
    blocks: Range<usize>,
    across: usize,
    to: &mut [u8],
) {
    samples_by(transform, component, blocks, across, to);
}

#[inline(always)]
fn samples_by<const N: usize>(
    transform: &Transform<N>,
    component: &Component,
    blocks: Range<usize>,
    across: usize,
    to: &mut [u8],
) {
    match across {
        8 => blocks_of::<N, 8>(transform, component, blocks, to),
        4 => blocks_of::<N, 4>(transform, component, blocks, to),
        2 => blocks_of::<N, 2>(transform, component, blocks, to),
        _ => blocks_of::<N, 1>(transform, component, blocks, to),
    }
}

/// A width known to the compiler makes copies of a row single instructions.
#[inline(always)]
fn blocks_of<const N: usize, const ACROSS: usize>(
    transform: &Transform<N>,
    component: &Component,
    blocks: Range<usize>,
    to: &mut [u8],
) {
    let stride = blocks.len() * ACROSS;
    for (column, block) in blocks.enumerate() {
        let samples = transform.samples(component, block);
        for (row, samples) in samples.as_chunks::<ACROSS>().0.iter().enumerate() {
            to[row * stride + column * ACROSS..][..ACROSS].copy_from_slice(samples);
        }
    }
}
