//! Resizing by OpenCV's `INTER_CUBIC`, without antialiasing: the input of PaddleDetection's detectors.

use image::RgbImage;

/// Sources of a pixel along one axis: four neighbours, clamped to the border, and their weights.
pub struct CubicTap {
    pub places: [usize; 4],
    pub weights: [f64; 4],
}

/// Returns the taps of Keys' cubic with a = -3/4, as in OpenCV.
pub fn cubic_taps(from: usize, to: usize) -> Vec<CubicTap> {
    const A: f64 = -0.75;
    let near = |x: f64| ((A + 2.0) * x - (A + 3.0)) * x * x + 1.0;
    let far = |x: f64| ((A * x - 5.0 * A) * x + 8.0 * A) * x - 4.0 * A;
    let tap = |i: usize| {
        let at = (i as f64 + 0.5) * (from as f64 / to as f64) - 0.5;
        let x = at - at.floor();
        let place = |step: isize| (at.floor() as isize + step).clamp(0, from as isize - 1) as usize;
        CubicTap {
            places: [-1, 0, 1, 2].map(place),
            weights: [far(1.0 + x), near(x), near(1.0 - x), far(2.0 - x)],
        }
    };
    (0..to).map(tap).collect()
}

/// Resizes a picture by cubic interpolation, as OpenCV from PyPI does for bytes, up to one level where a half is rounded. OpenCV built without
/// Intel's library rounds its weights to 1/2048, which changes a few bytes in a hundred by one level. An empty picture is unchanged.
pub fn opencv_cubic(picture: &RgbImage, [width, height]: [u32; 2]) -> RgbImage {
    if picture.dimensions() == (width, height) || picture.is_empty() {
        return picture.clone();
    }
    let stride = 3 * picture.width() as usize;
    let across = cubic_taps(picture.width() as usize, width as usize);
    let mut made = Vec::with_capacity(3 * width as usize * height as usize);
    for down in cubic_taps(picture.height() as usize, height as usize) {
        let rows = down
            .places
            .map(|row| &picture.as_raw()[row * stride..(row + 1) * stride]);
        for tap in &across {
            let mut sums = [0.0; 3];
            for (row, of_row) in rows.iter().zip(down.weights) {
                for (place, weight) in tap.places.into_iter().zip(tap.weights) {
                    let pixel = &row[3 * place..3 * place + 3];
                    sums.iter_mut()
                        .zip(pixel)
                        .for_each(|(sum, v)| *sum += of_row * weight * f64::from(*v));
                }
            }
            // The cast clamps to 0 and 255.
            made.extend(sums.map(|sum| sum.round_ties_even() as u8));
        }
    }
    RgbImage::from_raw(width, height, made).unwrap_or_default()
}
