//! Luma that is made where somebody looks: tags cover a small share of a large photo.

use std::borrow::Cow;
use std::cell::OnceCell;

use image::metadata::Orientation;
use image::{GrayImage, imageops};

use super::REDUCTIONS;
use super::jpeg::Coefficients;

/// Luma of an upright image.
pub trait Luma {
    /// Width and height, px.
    fn size(&self) -> [u32; 2];

    fn whole(&self) -> &GrayImage;

    /// A pixel for each square of `factor` × `factor` pixels, without what so few pixels cannot show; a rest at the right and at the bottom is left out.
    fn reduced(&self, factor: u32) -> Cow<'_, GrayImage>;

    /// The pixels from `(x, y)` on, `size` of them, all inside the image.
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
            _ => Cow::Owned(reduced(self, factor)),
        }
    }

    fn part(&self, [x, y]: [u32; 2], [width, height]: [u32; 2]) -> GrayImage {
        imageops::crop_imm(self, x, y, width, height).to_image()
    }
}

/// Of a JPEG that stores luma.
pub(super) struct JpegLuma<'a> {
    coefficients: &'a Coefficients,
    orientation: Orientation,
    size: [u32; 2],
    whole: OnceCell<GrayImage>,
}

impl<'a> JpegLuma<'a> {
    /// `size`: of the upright image.
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
        // A turned image leaves the rest out on the other side.
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

/// Means over squares of `factor` × `factor` pixels; a rest at the right and at the bottom is left out.
fn reduced(grey: &GrayImage, factor: u32) -> GrayImage {
    let (width, height) = (grey.width() / factor, grey.height() / factor);
    let (f, w) = (factor as usize, width as usize);
    let stride = grey.width() as usize;
    let mut bytes = Vec::with_capacity(w * height as usize);
    // Down first: neighbours are then added side by side. 16 bits hold 257 of them.
    let mut sums = vec![0u16; stride];
    let area = factor * factor;
    // Rounded up, so that whole numbers stay: exact for squares of up to 256 pixels' side.
    let per_area = (1u64 << 40).div_ceil(area.into());
    for rows in grey.as_raw().chunks_exact(stride * f) {
        sums.fill(0);
        for row in rows.chunks_exact(stride) {
            for (sum, pixel) in sums.iter_mut().zip(row) {
                *sum += u16::from(*pixel);
            }
        }
        let squares = sums
            .chunks_exact(f)
            .map(|sums| sums.iter().copied().map(u32::from).sum::<u32>());
        bytes.extend(squares.map(|sum| ((u64::from(sum + area / 2) * per_area) >> 40) as u8));
    }
    GrayImage::from_raw(width, height, bytes).unwrap_or_default()
}
