//! Part of an image around a tag.

use image::GrayImage;

use super::sides_px;
use scaleproof_core::geometry::extent;
use scaleproof_photo::Luma;

/// Pixels around a tag, with the position of its pixel (0, 0) in the image.
pub(super) struct Part {
    pub pixels: GrayImage,
    origin: [f64; 2],
}

/// Extra margin, px: the neighbouring pixels that interpolation needs.
const MARGIN_PX: f64 = 2.0;

impl Part {
    /// Returns the image up to `reach` bit cells and `reach_px` pixels from the corners of a tag that is `cells` of them across; it may be empty.
    pub(super) fn around(
        luma: &dyn Luma,
        corners_px: &[[f64; 2]; 4],
        cells: f64,
        (reach, reach_px): (f64, f64),
    ) -> Part {
        let longest = sides_px(corners_px).into_iter().fold(0.0, f64::max);
        let margin = longest / cells * reach + reach_px + MARGIN_PX;
        let most = luma.size();
        let ends = [0, 1].map(|k| {
            let (low, high) = extent(corners_px.map(|corner| corner[k]));
            // Numbers that are too large or NaN become the nearest end or 0.
            let start = ((low - margin).floor() as u32).min(most[k]);
            let end = ((high + margin).ceil() as u32).saturating_add(1).min(most[k]);
            (start, end.saturating_sub(start))
        });
        let (start, size) = (ends.map(|(start, _)| start), ends.map(|(_, size)| size));
        let pixels = (!size.contains(&0)).then(|| luma.part(start, size));
        Part {
            pixels: pixels.unwrap_or_default(),
            origin: start.map(f64::from),
        }
    }

    pub(super) fn inside<const N: usize>(&self, places_px: &[[f64; 2]; N]) -> [[f64; 2]; N] {
        places_px.map(|place| [0, 1].map(|k| place[k] - self.origin[k]))
    }

    pub(super) fn in_image(&self, places_px: &[[f64; 2]; 4]) -> [[f64; 2]; 4] {
        places_px.map(|place| [0, 1].map(|k| place[k] + self.origin[k]))
    }
}
