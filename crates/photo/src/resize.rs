//! Resizing: for networks as their own programs do, and smaller for display.

use image::{GrayImage, RgbImage};

use super::resample::{Filter, resampled};

/// Returns the size of a picture reduced to at most `longest_px` on its longer side; never enlarged.
pub fn fitting(size: [u32; 2], longest_px: u32) -> [u32; 2] {
    let share = (f64::from(longest_px) / f64::from(size[0].max(size[1]).max(1))).min(1.0);
    size.map(|side| (f64::from(side) * share).round().max(1.0) as u32)
}

/// Resizes a picture bilinearly with antialiasing, byte for byte as Pillow, and as torchvision up to rounding. An empty picture is unchanged.
pub fn shrunk(picture: &RgbImage, size: [u32; 2]) -> RgbImage {
    resized(picture, size, Filter::Bilinear)
}

/// Resizes a picture, each pixel the plain mean of those whose centres are in it. An empty picture is unchanged.
pub fn boxed(picture: &RgbImage, size: [u32; 2]) -> RgbImage {
    resized(picture, size, Filter::Box)
}

/// Doubles the size, bicubic. An empty picture is unchanged.
pub fn doubled(grey: &GrayImage) -> GrayImage {
    let (width, height) = grey.dimensions();
    grey_resized(grey, [2 * width, 2 * height], Filter::Bicubic)
}

/// Resizes as Pillow does. An empty picture is unchanged.
pub fn grey_resized(grey: &GrayImage, size: [u32; 2], filter: Filter) -> GrayImage {
    let from = <[u32; 2]>::from(grey.dimensions());
    if from == size || grey.is_empty() || size.contains(&0) {
        return grey.clone();
    }
    GrayImage::from_raw(size[0], size[1], resampled::<1>(grey, from, size, filter)).unwrap_or_default()
}

fn resized(picture: &RgbImage, size: [u32; 2], filter: Filter) -> RgbImage {
    let from = <[u32; 2]>::from(picture.dimensions());
    if from == size || picture.is_empty() || size.contains(&0) {
        return picture.clone();
    }
    let pixels = resampled::<3>(picture, from, size, filter);
    RgbImage::from_raw(size[0], size[1], pixels).unwrap_or_default()
}

/// Resizes a picture bilinearly as OpenCV's `INTER_LINEAR` for bytes, bit-exact: without antialiasing, in fixed point. Detectors whose own programs
/// resize with OpenCV get the same input.
///
/// The arithmetic is that of OpenCV 4's `resize` for 8 bits: weights in 1/2048, rows first, then columns with their low bits truncated, and the mean
/// of 2 × 2 if both sides are exactly halved. A test of the crate `detect` compares it with OpenCV's, byte for byte.
pub fn opencv_linear(picture: &RgbImage, size: [u32; 2]) -> RgbImage {
    if picture.dimensions() == size.into() {
        return picture.clone();
    }
    let ([columns, rows], [width, height]) = ([picture.width(), picture.height()], size);
    let made = if [2 * width, 2 * height] == [columns, rows] {
        halved(picture.as_raw(), width as usize)
    } else {
        let stride = 3 * columns as usize;
        interpolated(|row| &picture.as_raw()[row * stride..][..stride], [columns, rows], size)
    };
    RgbImage::from_raw(width, height, made).unwrap_or_default()
}

/// Returns, for each row of a picture, whether [`opencv_linear`] reads it: at most two per output row. `None` if it reads all.
pub(super) fn opencv_linear_rows(from: [u32; 2], to: [u32; 2]) -> Option<Vec<bool>> {
    if from[1] < 2 * to[1] || from == to.map(|side| 2 * side) {
        return None;
    }
    let (rows, height) = (from[1] as usize, to[1] as usize);
    let mut wanted = vec![false; rows];
    for tap in (0..height).map(|i| Tap::new(i, rows, height, false)) {
        tap.rows(rows).into_iter().for_each(|row| wanted[row] = true);
    }
    Some(wanted)
}

/// Computes [`opencv_linear`] from only these rows, which are stored one after the other.
pub(super) fn opencv_linear_of(found: &[u8], wanted: &[bool], columns: u32, size: [u32; 2]) -> RgbImage {
    let before = wanted.iter().scan(0, |count, is_wanted| {
        let place = *count;
        *count += usize::from(*is_wanted);
        Some(place)
    });
    let places: Vec<usize> = before.collect();
    let stride = 3 * columns as usize;
    let made = interpolated(
        |row| &found[places[row] * stride..][..stride],
        [columns, wanted.len() as u32],
        size,
    );
    RgbImage::from_raw(size[0], size[1], made).unwrap_or_default()
}

fn interpolated<'a>(source: impl Fn(usize) -> &'a [u8], from: [u32; 2], to: [u32; 2]) -> Vec<u8> {
    let ([columns, rows], [width, height]) = (from.map(|side| side as usize), to.map(|side| side as usize));
    let across: Vec<Tap> = (0..width).map(|i| Tap::new(i, columns, width, true)).collect();
    let mut out = Vec::with_capacity(3 * width * height);
    let [mut upper, mut lower] = [0; 2].map(|_| Row {
        number: None,
        sums: vec![0; 3 * width],
    });
    for tap in (0..height).map(|i| Tap::new(i, rows, height, false)) {
        let wanted = tap.rows(rows);
        // The lower row is often the next upper one.
        if lower.number == Some(wanted[0]) {
            std::mem::swap(&mut upper, &mut lower);
        }
        upper.fill(wanted[0], &source, &across);
        lower.fill(wanted[1], &source, &across);
        let [a, b] = tap.weights;
        let pairs = upper.sums.iter().zip(&lower.sums);
        out.extend(pairs.map(|(s, t)| ((((a * (s >> 4)) >> 16) + ((b * (t >> 4)) >> 16) + 2) >> 2) as u8));
    }
    out
}

/// Unit of weights, which are in 1/2048.
const ONE: f32 = 2048.0;

/// Sources of a pixel: the first of two neighbours, and the weights of both.
#[derive(Clone, Copy)]
struct Tap {
    /// Index of the first; -1 before the border.
    first: isize,
    weights: [i32; 2],
}

impl Tap {
    /// Returns the tap of pixel `i` of `to`, among `from`. If `is_held`, only the border pixel counts beyond the border: as in OpenCV across; down,
    /// rows are clamped to the border instead.
    fn new(i: usize, from: usize, to: usize, is_held: bool) -> Tap {
        let scale = 1.0 / (to as f64 / from as f64);
        let at = ((i as f64 + 0.5) * scale - 0.5) as f32;
        let (mut first, mut share, last) = (at.floor() as isize, at - at.floor(), from as isize - 1);
        if is_held && (first < 0 || first >= last) {
            (first, share) = (first.clamp(0, last), 0.0);
        }
        let weights = [1.0 - share, share].map(|share| (share * ONE).round_ties_even() as i32);
        Tap { first, weights }
    }

    /// Returns the two neighbours, clamped to this number of rows.
    fn rows(self, count: usize) -> [usize; 2] {
        [self.first, self.first + 1].map(|row| row.clamp(0, count as isize - 1) as usize)
    }
}

/// Row of the source at the new width, in 1/2048.
struct Row {
    number: Option<usize>,
    sums: Vec<i32>,
}

impl Row {
    fn fill<'a>(&mut self, number: usize, source: &impl Fn(usize) -> &'a [u8], across: &[Tap]) {
        if self.number == Some(number) {
            return;
        }
        self.number = Some(number);
        let row = source(number);
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

fn halved(source: &[u8], width: usize) -> Vec<u8> {
    let pairs_of_rows = source.chunks_exact(12 * width).map(|rows| rows.split_at(6 * width));
    let squares =
        pairs_of_rows.flat_map(|(upper, lower)| upper.as_chunks::<6>().0.iter().zip(lower.as_chunks::<6>().0));
    let mean = |[u, l]: [&[u8; 6]; 2], c: usize| {
        let sum: u32 = [u[c], u[c + 3], l[c], l[c + 3]].map(u32::from).iter().sum();
        ((sum + 2) >> 2) as u8
    };
    squares.flat_map(|(u, l)| [0, 1, 2].map(|c| mean([u, l], c))).collect()
}
