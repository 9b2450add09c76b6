//! Geometry of the image that replaces a picture.

use image::{RgbImage, imageops};

use scaleproof_core::geometry::BoxPx;

/// Part of a picture, possibly enlarged, on black.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Frame {
    /// Left and top of the part, and its size, px of the picture.
    part: [[u32; 2]; 2],
    /// Size of the part in the image, px.
    resized: [u32; 2],
    /// Position of the part in the image, px.
    at: [u32; 2],
    /// Size of the image, px.
    size: [u32; 2],
}

impl Frame {
    /// Returns the frame of a whole picture of this size, width and height, px.
    pub fn whole(size: [u32; 2]) -> Self {
        Self::crop([0, 0], size)
    }

    /// Returns the frame of the part at this corner, left and top, of this size, px.
    pub fn crop(corner: [u32; 2], size: [u32; 2]) -> Self {
        Self {
            part: [corner, size],
            resized: size,
            at: [0, 0],
            size,
        }
    }

    pub(super) fn padded(picture: [u32; 2], resized: [u32; 2], at: [u32; 2], size: [u32; 2]) -> Self {
        Self {
            part: [[0, 0], picture],
            resized,
            at,
            size,
        }
    }

    /// Returns the bounds of the whole image in the picture, px; they may exceed the picture.
    pub fn window(&self) -> BoxPx {
        let [low, high] = [
            self.at.map(|at| -i64::from(at)),
            [0, 1].map(|i| i64::from(self.size[i]) - i64::from(self.at[i])),
        ];
        let in_picture = |ends: [i64; 2], i: usize| {
            let [corner, size] = [self.part[0][i], self.part[1][i]].map(f64::from);
            corner + ends[i] as f64 * size / f64::from(self.resized[i])
        };
        BoxPx::new(
            in_picture(low, 0),
            in_picture(low, 1),
            in_picture(high, 0),
            in_picture(high, 1),
        )
    }

    /// Cuts the image out of a picture; the part is enlarged without smoothing, as by Xie et al.
    pub fn cut(&self, picture: &RgbImage) -> RgbImage {
        let [[x, y], [width, height]] = self.part;
        let mut part = imageops::crop_imm(picture, x, y, width, height).to_image();
        if part.dimensions() != self.resized.into() {
            let [across, down] = self.resized;
            part = imageops::resize(&part, across, down, imageops::FilterType::Nearest);
        }
        if self.size == self.resized {
            return part;
        }
        let mut image = RgbImage::new(self.size[0], self.size[1]);
        imageops::replace(&mut image, &part, self.at[0].into(), self.at[1].into());
        image
    }
}
