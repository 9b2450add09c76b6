//! A photo in linear light.

use image::RgbImage;

use crate::frames::light;

/// A photo's light, reduced by the mean of squares of pixels: linear in sRGB's primaries, 1 is white.
pub(super) struct LightImage {
    width: usize,
    height: usize,
    /// Width and height of the photo, px.
    photo: [f64; 2],
    /// A pixel here is so many of the photo's pixels wide and high.
    reduction: usize,
    pixels: Vec<[f32; 3]>,
}

impl LightImage {
    /// Pixels at the right and lower border that fill no square are left to the last one.
    pub(super) fn new(photo: &RgbImage, reduction: usize) -> Self {
        let levels: [f32; 256] = std::array::from_fn(|level| light::decode(level as f64 / 255.0) as f32);
        let (width, height) = (photo.width() as usize / reduction, photo.height() as usize / reduction);
        let mut pixels = vec![[0.0_f32; 3]; width * height];
        let share = 1.0 / (reduction * reduction) as f32;
        for (y, row) in photo.rows().take(height * reduction).enumerate() {
            for (x, pixel) in row.take(width * reduction).enumerate() {
                let sum = &mut pixels[y / reduction * width + x / reduction];
                (0..3).for_each(|c| sum[c] += share * levels[usize::from(pixel.0[c])]);
            }
        }
        Self {
            width,
            height,
            photo: [photo.width(), photo.height()].map(f64::from),
            reduction,
            pixels,
        }
    }

    /// The light at a pixel of the photo, bilinear; `None` outside the image.
    pub(super) fn at(&self, pixel: [f64; 2]) -> Option<[f64; 3]> {
        if (0..2).any(|i| !(-0.5..=self.photo[i] - 0.5).contains(&pixel[i])) {
            return None;
        }
        let here = pixel.map(|v| (v + 0.5) / self.reduction as f64 - 0.5);
        let (x0, x1, tx) = neighbours(here[0], self.width);
        let (y0, y1, ty) = neighbours(here[1], self.height);
        let at = |x: usize, y: usize| self.pixels[y * self.width + x];
        let [a, b, c, d] = [at(x0, y0), at(x1, y0), at(x0, y1), at(x1, y1)];
        let mix = |from: f64, to: f64, share: f64| from + share * (to - from);
        Some(std::array::from_fn(|i| {
            let row = |l: [f32; 3], r: [f32; 3]| mix(f64::from(l[i]), f64::from(r[i]), tx);
            mix(row(a, b), row(c, d), ty)
        }))
    }
}

/// The two pixels about a place on one axis, and the second one's share.
fn neighbours(place: f64, size: usize) -> (usize, usize, f64) {
    let place = place.clamp(0.0, (size - 1) as f64);
    let first = place as usize;
    (first, (first + 1).min(size - 1), place - first as f64)
}
