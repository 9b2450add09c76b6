//! Sampling of a cell's pixels as light.

use image::RgbImage;
use palette::Srgb;

use super::find::FoundChart;
use super::layout::ChartCell;
use scaleproof_core::geometry::extent;

/// Side of the sampled square in the middle of a cell: 2.5 mm of the patch around it are left for blur, lens distortion and paper that is not quite
/// flat.
pub const SAMPLED_MM: f64 = 5.0;
/// Number of parts per side into which the square is also divided.
pub const PARTS: usize = 3;
/// Lowest level that counts as clipped.
const CLIPPED: u8 = 254;

/// Sampled light of a cell, linear in the primaries of sRGB; 1 is the end of the camera's scale.
#[derive(Debug, Clone, PartialEq)]
pub struct PatchSample {
    /// Mean of the middle half of the pixels, channel by channel: a speck or a hair does not count.
    pub light: [f64; 3],
    /// Light of each of the [`PARTS`]² parts of the square, row by row, averaged in the same way.
    pub parts: Vec<[f64; 3]>,
    /// Share of pixels with a channel at the upper end of the scale.
    pub clipped: f64,
    /// Share of pixels with a channel at 0.
    pub at_zero: f64,
}

/// Samples a cell. `None` if a part of it lies outside the photo or has no pixel.
pub fn sample(photo: &RgbImage, chart: &FoundChart, cell: ChartCell) -> Option<PatchSample> {
    let [cx, cy] = cell.centre_mm();
    let h = SAMPLED_MM / 2.0;
    let corners = [[cx - h, cy - h], [cx + h, cy - h], [cx + h, cy + h], [cx - h, cy + h]].map(|mm| chart.px(mm));
    let columns = span(corners.map(|c| c[0]), photo.width())?;
    let rows = span(corners.map(|c| c[1]), photo.height())?;
    let mut parts: Vec<Vec<[u8; 3]>> = vec![Vec::new(); PARTS * PARTS];
    for y in rows {
        for x in columns.clone() {
            let [mm_x, mm_y] = chart.mm([f64::from(x), f64::from(y)]);
            let part = |from_edge: f64| (from_edge / SAMPLED_MM * PARTS as f64).floor();
            let (column, row) = (part(mm_x - cx + h), part(mm_y - cy + h));
            let within = |part: f64| part >= 0.0 && part < PARTS as f64;
            if within(column) && within(row) {
                parts[row as usize * PARTS + column as usize].push(photo.get_pixel(x, y).0);
            }
        }
    }
    if parts.iter().any(Vec::is_empty) {
        return None;
    }
    let all: Vec<[u8; 3]> = parts.concat();
    let share = |is: fn(u8) -> bool| {
        let count = all.iter().filter(|pixel| pixel.iter().any(|level| is(*level))).count();
        count as f64 / all.len() as f64
    };
    Some(PatchSample {
        light: middle_mean(&all),
        parts: parts.iter().map(|part| middle_mean(part)).collect(),
        clipped: share(|level| level >= CLIPPED),
        at_zero: share(|level| level == 0),
    })
}

/// Returns the pixel range that covers the positions; `None` if it leaves the photo.
fn span(places: [f64; 4], side: u32) -> Option<std::ops::RangeInclusive<u32>> {
    let (low, high) = extent(places);
    let (low, high) = (low.floor(), high.ceil());
    (low >= 0.0 && high <= f64::from(side) - 1.0).then_some(low as u32..=high as u32)
}

/// Returns the interquartile mean of each channel, in light.
fn middle_mean(pixels: &[[u8; 3]]) -> [f64; 3] {
    [0, 1, 2].map(|channel| {
        let mut levels: Vec<u8> = pixels.iter().map(|pixel| pixel[channel]).collect();
        levels.sort_unstable();
        let quarter = levels.len() / 4;
        let middle = &levels[quarter..levels.len() - quarter];
        middle.iter().map(|level| linear(*level)).sum::<f64>() / middle.len() as f64
    })
}

/// Returns the light of an 8-bit level (IEC 61966-2-1).
fn linear(level: u8) -> f64 {
    Srgb::new(level, level, level).into_format::<f64>().into_linear().red
}
