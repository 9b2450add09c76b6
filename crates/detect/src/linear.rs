//! Bilinear resizing as OpenCV's `INTER_LINEAR` has it for bytes, number for number: without antialiasing, in fixed point. Detectors whose
//! own programs resize with OpenCV are scored on the image that those would show them.
//!
//! The arithmetic is that of OpenCV 4's `resize` for 8 bits: weights in 1/2048, rows first, then columns with their low bits cut off, and the
//! mean of 2 × 2 where both sides are exactly halved. A test below holds it against OpenCV's, byte for byte.

use image::RgbImage;

/// Weights are in 1/2048.
const ONE: f32 = 2048.0;

/// Where a pixel comes from: the first of two neighbours, and the weights of both.
#[derive(Clone, Copy)]
struct Tap {
    /// -1 for the one before the border.
    first: isize,
    weights: [i32; 2],
}

impl Tap {
    /// Of the pixel `i` of `to`, among `from`.
    fn of(i: usize, from: usize, to: usize) -> Tap {
        let scale = 1.0 / (to as f64 / from as f64);
        let at = ((i as f64 + 0.5) * scale - 0.5) as f32;
        Tap::weighted(at.floor() as isize, at - at.floor())
    }

    /// Like [`Tap::of`], but beyond the border the border pixel counts alone: OpenCV does so across, and holds rows at the border down.
    fn held(i: usize, from: usize, to: usize) -> Tap {
        let (tap, last) = (Tap::of(i, from, to), from as isize - 1);
        if tap.first < 0 || tap.first >= last {
            Tap::weighted(tap.first.clamp(0, last), 0.0)
        } else {
            tap
        }
    }

    fn weighted(first: isize, share: f32) -> Tap {
        let weight = |share: f32| (share * ONE).round_ties_even() as i32;
        Tap {
            first,
            weights: [weight(1.0 - share), weight(share)],
        }
    }
}

/// Interleaved RGB bytes of a photo at another size, width before height.
pub(super) fn resized(photo: &RgbImage, [width, height]: [u32; 2]) -> Vec<u8> {
    let (columns, rows) = (photo.width() as usize, photo.height() as usize);
    let (width, height) = (width as usize, height as usize);
    let source = photo.as_raw().as_slice();
    if (width, height) == (columns, rows) {
        return source.to_vec();
    }
    if (2 * width, 2 * height) == (columns, rows) {
        return halved(source, width, height);
    }
    let across: Vec<Tap> = (0..width).map(|i| Tap::held(i, columns, width)).collect();
    let mut out = Vec::with_capacity(3 * width * height);
    let mut upper = Row::of(3 * width);
    let mut lower = Row::of(3 * width);
    for tap in (0..height).map(|i| Tap::of(i, rows, height)) {
        let wanted = [tap.first, tap.first + 1].map(|row| row.clamp(0, rows as isize - 1) as usize);
        // The lower row is often the next upper one.
        if lower.number == Some(wanted[0]) {
            std::mem::swap(&mut upper, &mut lower);
        }
        upper.fill(wanted[0], source, 3 * columns, &across);
        lower.fill(wanted[1], source, 3 * columns, &across);
        let [a, b] = tap.weights;
        let pairs = upper.sums.iter().zip(&lower.sums);
        out.extend(pairs.map(|(s, t)| ((((a * (s >> 4)) >> 16) + ((b * (t >> 4)) >> 16) + 2) >> 2) as u8));
    }
    out
}

/// A row of the source at the new width, in 1/2048.
struct Row {
    number: Option<usize>,
    sums: Vec<i32>,
}

impl Row {
    fn of(length: usize) -> Row {
        Row {
            number: None,
            sums: vec![0; length],
        }
    }

    fn fill(&mut self, number: usize, source: &[u8], stride: usize, across: &[Tap]) {
        if self.number == Some(number) {
            return;
        }
        self.number = Some(number);
        let row = &source[number * stride..(number + 1) * stride];
        for (sums, tap) in self.sums.as_chunks_mut::<3>().0.iter_mut().zip(across) {
            let [a, b] = tap.weights;
            let first = tap.first as usize * 3;
            let next = if b == 0 { first } else { first + 3 };
            for channel in 0..3 {
                sums[channel] = a * i32::from(row[first + channel]) + b * i32::from(row[next + channel]);
            }
        }
    }
}

fn halved(source: &[u8], width: usize, height: usize) -> Vec<u8> {
    let stride = 6 * width;
    let at = |x: usize, y: usize, channel: usize| u32::from(source[y * stride + 3 * x + channel]);
    let mut out = Vec::with_capacity(3 * width * height);
    for y in 0..height {
        for x in 0..width {
            for channel in 0..3 {
                let sum = at(2 * x, 2 * y, channel)
                    + at(2 * x + 1, 2 * y, channel)
                    + at(2 * x, 2 * y + 1, channel)
                    + at(2 * x + 1, 2 * y + 1, channel);
                out.push(((sum + 2) >> 2) as u8);
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use opencv::core::{Mat, Size};
    use opencv::imgproc;
    use opencv::prelude::*;
    use proptest::prelude::*;

    use super::*;

    fn by_opencv(photo: &RgbImage, [width, height]: [u32; 2]) -> Vec<u8> {
        let flat = Mat::from_slice(photo.as_raw().as_slice()).unwrap();
        let source = flat.reshape(3, photo.height() as i32).unwrap();
        let (size, mut resized) = (Size::new(width as i32, height as i32), Mat::default());
        imgproc::resize(&source, &mut resized, size, 0.0, 0.0, imgproc::INTER_LINEAR).unwrap();
        resized.data_bytes().unwrap().to_vec()
    }

    fn noise(width: u32, height: u32, seed: u32) -> RgbImage {
        let mut state = seed | 1;
        RgbImage::from_fn(width, height, |_, _| {
            image::Rgb([0; 3].map(|_: u8| {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                (state >> 24) as u8
            }))
        })
    }

    /// Two pixels to a column: a case that failed once.
    #[test]
    fn a_row_that_becomes_a_column_is_opencvs() {
        let photo = noise(2, 1, 490_256_226);
        assert_eq!(resized(&photo, [1, 2]), by_opencv(&photo, [1, 2]));
    }

    proptest! {
        /// Smaller, larger, halved, one side only: noise shows every rounding.
        #[test]
        fn every_byte_is_opencvs(
            from in prop::array::uniform2(1..150_u32), to in prop::array::uniform2(1..150_u32), kind in 0..4_u8, seed in any::<u32>(),
        ) {
            let from = match kind {
                0 => to.map(|side| 2 * side),
                1 => [2 * to[0], from[1]],
                2 => [from[0], to[1]],
                _ => from,
            };
            let photo = noise(from[0], from[1], seed);
            prop_assert_eq!(resized(&photo, to), by_opencv(&photo, to), "{:?} to {:?}", from, to);
        }
    }
}
