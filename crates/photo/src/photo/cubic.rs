//! Pictures at another size by OpenCV's `INTER_CUBIC`, without antialiasing: what detectors of PaddleDetection are shown.

use image::RgbImage;

/// What makes a pixel along one axis: four neighbours, of which those beyond the border are its pixel, and what each counts.
pub struct CubicTap {
    pub places: [usize; 4],
    pub weights: [f64; 4],
}

/// Keys' cubic with a = -3/4, as OpenCV has it.
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

/// The picture at another size, cubic, as OpenCV from PyPI has it for bytes but for one level where a half is rounded. OpenCV built without
/// Intel's library rounds its weights to 1/2048, which moves a few bytes in a hundred by one level. An empty picture stays.
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
            // A cast ends at 0 and 255.
            made.extend(sums.map(|sum| sum.round_ties_even() as u8));
        }
    }
    RgbImage::from_raw(width, height, made).unwrap_or_default()
}
