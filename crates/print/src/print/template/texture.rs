//! A texture at the resolution of the print.

use std::sync::Arc;

use image::RgbImage;

use scaleproof_surface::pattern::area::averaged;
use scaleproof_surface::pattern::picture::Picture;

const MM_PER_INCH: f64 = 25.4;

/// One repeat, of this width and height, in pixels that are the mean light of their areas; an image that has fewer stays as it is.
pub(super) fn resampled(texture: &Picture, (width_mm, height_mm): (f64, f64), dpi: f64) -> Arc<RgbImage> {
    let (width, height) = texture.pixels.dimensions();
    let most = |mm: f64| (mm / MM_PER_INCH * dpi).round().max(1.0);
    let size = [(width, width_mm), (height, height_mm)].map(|(pixels, mm)| most(mm).min(f64::from(pixels)) as u32);
    if size == [width, height] {
        return Arc::clone(&texture.pixels);
    }
    Arc::new(averaged(&texture.pixels, size, 1.0))
}
