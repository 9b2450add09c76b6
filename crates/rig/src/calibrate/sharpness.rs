//! Blur of a photo, measured where it matters: at the board's corners.

use image::GrayImage;

use super::board_photo::SeenCorner;
use scaleproof_core::statistics::upper_median;

/// Width above which edges are blurred, px: a corner is then found, but where a moving camera smeared it. Sharp photos measure 3 to 5 px.
pub(super) const BLURRED_PX: f64 = 9.0;

/// Half side of the square around a corner that is measured, px.
const HALF: i64 = 7;

/// Returns the width of the edges at the board's corners in px, in the direction in which the photo is most blurred; the median over
/// the corners, `None` without any that lies far enough inside.
///
/// An edge of contrast C and width w, crossing a square of side s, adds s·C²/w to the sum of squared gradients across it, so w follows
/// from the smaller eigenvalue of the structure tensor (Förstner & Gülch 1987).
pub(super) fn edge_width_px(grey: &GrayImage, corners: &[SeenCorner]) -> Option<f64> {
    let widths: Vec<f64> = corners.iter().filter_map(|c| width_at(grey, c.px)).collect();
    upper_median(&widths)
}

fn width_at(grey: &GrayImage, [x, y]: [f64; 2]) -> Option<f64> {
    let (x, y) = (x.round() as i64, y.round() as i64);
    let (width, height) = (i64::from(grey.width()), i64::from(grey.height()));
    let reach = HALF + 1;
    if x < reach || y < reach || x + reach >= width || y + reach >= height {
        return None;
    }
    let at = |x: i64, y: i64| f64::from(grey.get_pixel(x as u32, y as u32).0[0]);
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    let mut tones = Vec::new();
    for v in y - HALF..=y + HALF {
        for u in x - HALF..=x + HALF {
            let (gx, gy) = ((at(u + 1, v) - at(u - 1, v)) / 2.0, (at(u, v + 1) - at(u, v - 1)) / 2.0);
            (xx, xy, yy) = (xx + gx * gx, xy + gx * gy, yy + gy * gy);
            tones.push(at(u, v));
        }
    }
    tones.sort_by(f64::total_cmp);
    let contrast = tones[tones.len() * 19 / 20] - tones[tones.len() / 20];
    let smaller = (xx + yy) / 2.0 - ((xx - yy) / 2.0).hypot(xy);
    (smaller > 0.0 && contrast > 0.0).then(|| (2 * HALF + 1) as f64 * contrast * contrast / smaller)
}
