//! Measurement of blur and paper level at the tags of a photo: the print is known, so its image tells focus and light.

use image::{GrayImage, RgbImage};

use super::blur::{self, EdgeBlur};
use super::part::Part;
use super::{SeenTag, TagHomography, border, refine};
use scaleproof_core::geometry::distance;
use scaleproof_core::statistics::upper_median;
use scaleproof_photo::Luma;

/// Half width of the band about a side in which its blur is fitted, in bit cells and px, as in the fit of corners.
const BAND_CELLS: f64 = 0.6;
const MAX_BAND_PX: f64 = 6.0;

/// Minimum width of a bit cell, px: narrower cells cannot be distinguished from blur.
const MIN_CELL_PX: f64 = 3.0;

/// Share of a cell left out at the ends of a side.
const END_CELLS: f64 = 0.5;

/// Blur and paper level measured at the whole tags of a photo.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Appearance {
    /// Standard deviation of the blur of the tags' borders, px, in the direction of the image that is most blurred: motion blurs one only.
    /// Infinity when most sides are too blurred to be fitted, `None` when no whole tag is large enough to tell.
    pub blur_px: Option<f64>,
    /// Grey level of the paper beside the tags, 0–255: the median. `None` without a whole tag.
    pub white_level: Option<f64>,
}

impl Appearance {
    /// Measures the whole tags of a photo; covered and cut ones are no measure of focus.
    pub fn measure(grey: &GrayImage, tags: &[SeenTag]) -> Appearance {
        let whole = || tags.iter().filter(|tag| tag.is_whole);
        Appearance {
            blur_px: blur::worst_px(&edge_blurs(grey, tags)),
            white_level: upper_median(&whole().filter_map(|tag| white(grey, tag)).collect::<Vec<_>>()),
        }
    }
}

/// Returns the blur of every measurable side of the whole tags; covered and cut tags are no measure of focus.
pub fn edge_blurs(luma: &dyn Luma, tags: &[SeenTag]) -> Vec<EdgeBlur> {
    let whole = tags.iter().enumerate().filter(|(_, tag)| tag.is_whole);
    let sides = whole.flat_map(|(at, tag)| (0..4).map(move |side| (at, tag, side)));
    sides
        .filter_map(|(at, tag, side)| side_blur(luma, (at, tag), side))
        .collect()
}

/// Returns the 8-bit level of the paper beside each tag, per channel; `None` if this area is not wholly in the image.
pub fn paper_levels(rgb: &RgbImage, tags: &[SeenTag]) -> Vec<Option<[f64; 3]>> {
    let (width, height) = rgb.dimensions();
    let channels = [0, 1, 2].map(|c| GrayImage::from_fn(width, height, |x, y| image::Luma([rgb.get_pixel(x, y).0[c]])));
    let level = |tag: &SeenTag| {
        let [r, g, b] = [0, 1, 2].map(|c| white(&channels[c], tag));
        Some([r?, g?, b?])
    };
    tags.iter().map(level).collect()
}

/// Measures the blur of a tag's side; `None` if its cells are too small, or it touches the image's border.
fn side_blur(luma: &dyn Luma, (at, tag): (usize, &SeenTag), side: usize) -> Option<EdgeBlur> {
    let cells = tag.family.cells_across();
    let homography = TagHomography::to(&tag.corners_px);
    let cell = refine::cell_px(&homography, side, cells);
    if cell.is_nan() || cell < MIN_CELL_PX {
        return None;
    }
    let end = END_CELLS / cells;
    let [from, to] = [end, 1.0 - end].map(|share| homography.pixel_at(side, share, 0.0));
    let px = match tag.side_blurs_px {
        Some(blurs) => blurs[side],
        None => {
            let part = Part::around(luma, &tag.corners_px, cells, refine::REACH);
            let [from, to] = part.inside(&[from, to]);
            refine::edge_blur(&part.pixels, from, to, (BAND_CELLS * cell).min(MAX_BAND_PX))?
        }
    };
    let length = distance(from, to);
    let normal = [(from[1] - to[1]) / length, (to[0] - from[0]) / length];
    Some(EdgeBlur {
        tag: at,
        side,
        normal,
        px,
    })
}

/// Returns the level of the lighter of the rings half a cell inside and outside the outline: families differ in which that is.
fn white(grey: &GrayImage, tag: &SeenTag) -> Option<f64> {
    let half_cell = 0.5 / tag.family.cells_across();
    let homography = TagHomography::to(&tag.corners_px);
    let tone = |depth| upper_median(&border::ring(grey, &homography, depth)?);
    Some(tone(half_cell)?.max(tone(-half_cell)?))
}
