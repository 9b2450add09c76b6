//! Luma computed only where it is needed: tags cover a small share of a large photo.

use std::borrow::Cow;
use std::cell::OnceCell;
use std::ops::Deref;

use image::metadata::Orientation;
use image::{GrayImage, ImageBuffer, imageops};

use super::jpeg::{Coefficients, REDUCTIONS};

/// Luma of an upright image.
pub trait Luma {
    /// Returns width and height, px.
    fn size(&self) -> [u32; 2];

    fn whole(&self) -> &GrayImage;

    /// Returns a pixel for each square of `factor` × `factor` pixels, low-pass filtered; a remainder at the right and at the bottom is left out.
    fn reduced(&self, factor: u32) -> Cow<'_, GrayImage>;

    /// Returns `size` pixels from `start` (x, y) on, all inside the image.
    fn part(&self, start: [u32; 2], size: [u32; 2]) -> GrayImage;
}

impl Luma for GrayImage {
    fn size(&self) -> [u32; 2] {
        self.dimensions().into()
    }

    fn whole(&self) -> &GrayImage {
        self
    }

    fn reduced(&self, factor: u32) -> Cow<'_, GrayImage> {
        match factor {
            1 => Cow::Borrowed(self),
            _ => Cow::Owned(mean_squares(self, factor)),
        }
    }

    fn part(&self, [x, y]: [u32; 2], [width, height]: [u32; 2]) -> GrayImage {
        imageops::crop_imm(self, x, y, width, height).to_image()
    }
}

/// Luma of a JPEG that stores it.
pub(super) struct JpegLuma<'a> {
    coefficients: &'a Coefficients,
    orientation: Orientation,
    size: [u32; 2],
    whole: OnceCell<GrayImage>,
}

impl<'a> JpegLuma<'a> {
    /// Creates the luma; `size` is that of the upright image.
    pub(super) fn new(coefficients: &'a Coefficients, orientation: Orientation, size: [u32; 2]) -> JpegLuma<'a> {
        JpegLuma {
            coefficients,
            orientation,
            size,
            whole: OnceCell::new(),
        }
    }
}

impl Luma for JpegLuma<'_> {
    fn size(&self) -> [u32; 2] {
        self.size
    }

    fn whole(&self) -> &GrayImage {
        self.whole.get_or_init(|| self.coefficients.luma(1, self.orientation))
    }

    fn reduced(&self, factor: u32) -> Cow<'_, GrayImage> {
        // A rotated image leaves the remainder out on the other side.
        let is_whole = self.size.iter().all(|side| side.is_multiple_of(factor));
        if is_whole && REDUCTIONS.contains(&factor) {
            Cow::Owned(self.coefficients.luma(factor, self.orientation))
        } else {
            self.whole().reduced(factor)
        }
    }

    fn part(&self, start: [u32; 2], size: [u32; 2]) -> GrayImage {
        let is_made = self.whole.get().is_some();
        let made = (!is_made).then(|| self.coefficients.luma_part(start, size, self.orientation));
        made.flatten().unwrap_or_else(|| self.whole().part(start, size))
    }
}

/// Returns means over squares of `factor` × `factor` pixels; a remainder at the right and at the bottom is left out.
pub fn mean_squares<C: Deref<Target = [u8]>>(grey: &ImageBuffer<image::Luma<u8>, C>, factor: u32) -> GrayImage {
    let (width, height) = (grey.width() / factor, grey.height() / factor);
    let stride = grey.width() as usize;
    let mut bytes = Vec::with_capacity(width as usize * height as usize);
    // Columns are summed first: adjacent pixels are then added in parallel. 16 bits hold the sum of 257 pixels.
    let mut sums = vec![0u16; stride];
    for rows in grey.as_raw().chunks_exact(stride * factor as usize) {
        sums.fill(0);
        for row in rows.chunks_exact(stride) {
            for (sum, pixel) in sums.iter_mut().zip(row) {
                *sum += u16::from(*pixel);
            }
        }
        match factor {
            2 => add_means::<2>(&sums, &mut bytes),
            3 => add_means::<3>(&sums, &mut bytes),
            4 => add_means::<4>(&sums, &mut bytes),
            _ => {
                let area = factor * factor;
                let squares = sums.chunks_exact(factor as usize);
                let squares = squares.map(|sums| sums.iter().copied().map(u32::from).sum::<u32>());
                bytes.extend(squares.map(|sum| ((sum + area / 2) / area) as u8));
            }
        }
    }
    GrayImage::from_raw(width, height, bytes).unwrap_or_default()
}

/// Appends means of squares of a side known at compile time, so that several take one instruction. `sums`: of their columns.
fn add_means<const SIDE: usize>(sums: &[u16], means: &mut Vec<u8>) {
    let area = (SIDE * SIDE) as u32;
    // Rounded up, so that constant squares keep their level: exact for sums below 2¹⁶; the sums of such squares are below 2¹², so 32 bits suffice.
    let per_area = (1u32 << 20).div_ceil(area);
    let squares = sums.as_chunks::<SIDE>().0.iter();
    let squares = squares.map(|sums| sums.iter().copied().map(u32::from).sum::<u32>());
    means.extend(squares.map(|sum| (((sum + area / 2) * per_area) >> 20) as u8));
}
