//! Corners to a few hundredths of a pixel: each side's blurred edge is fitted to the full-size picture, neighbours are
//! intersected.
//!
//! Blur mixes *light*, not grey levels. In the sRGB encoding of a JPEG the half-way grey level of a blurred edge is 21 % of
//! the light, so that a detector that looks for it sees the dark square too small, all round. The fit is therefore made in
//! linear light.

use image::GrayImage;

use super::Square;
use super::edge::{self, Edge, Sample};

/// A stretch of this many pixels fixes a line well; longer ones cost time, and bend in a lens with distortion.
const REACH_PX: f64 = 64.0;

/// Half width of the band of pixels about an edge.
const MAX_BAND_PX: f64 = 6.0;
const MIN_BAND_PX: f64 = 1.0;

/// The clean space on either side of an edge is one bit cell; the band keeps this share of it, away from the next cell's blur.
const BAND_CELLS: f64 = 0.8;

/// Share of a cell left out at the ends of a side, where the neighbouring side's blur mixes in.
const END_CELLS: f64 = 0.5;

/// A fit that moved a corner by more than this is repeated with the band where the edge is.
const CENTRED_PX: f64 = 0.25;
const MAX_ROUNDS: usize = 3;

/// The corners, px, moved onto the edges' intersections; `None` when some edge cannot be seen well enough.
///
/// `corners_px` must be within half a cell. `cells`: width of the outline in bit cells.
pub(super) fn refine(grey: &GrayImage, corners_px: &[[f64; 2]; 4], cells: f64) -> Option<[[f64; 2]; 4]> {
    let mut corners = *corners_px;
    for _ in 0..MAX_ROUNDS {
        let refined = once(grey, &corners, cells)?;
        let moved = |a: &[[f64; 2]; 4]| (0..4).map(|i| distance(a[i], refined[i])).fold(0.0, f64::max);
        let (step, in_all) = (moved(&corners), moved(corners_px));
        if in_all > shortest_side(corners_px) / cells {
            return None;
        }
        corners = refined;
        if step < CENTRED_PX {
            break;
        }
    }
    Some(corners)
}

fn once(grey: &GrayImage, corners: &[[f64; 2]; 4], cells: f64) -> Option<[[f64; 2]; 4]> {
    let square = Square::onto(corners);
    let mut ends: Vec<(Line, Line)> = Vec::with_capacity(4);
    for side in 0..4 {
        ends.push(lines_of_side(grey, corners, side, &square, cells)?);
    }
    let mut refined = [[0.0; 2]; 4];
    for (i, corner) in refined.iter_mut().enumerate() {
        *corner = ends[(i + 3) % 4].1.meets(&ends[i].0)?;
    }
    Some(refined)
}

/// A side's line near its first and near its second corner; the same one when the side is short.
fn lines_of_side(
    grey: &GrayImage,
    corners: &[[f64; 2]; 4],
    side: usize,
    square: &Square,
    cells: f64,
) -> Option<(Line, Line)> {
    let (from, to) = (corners[side], corners[(side + 1) % 4]);
    let length = distance(from, to);
    let band = (BAND_CELLS * cell_px(square, side, cells)).min(MAX_BAND_PX);
    let skip = END_CELLS * length / cells;
    if band < MIN_BAND_PX || length - 2.0 * skip < 4.0 {
        return None;
    }
    let stretch = |start: f64, end: f64| {
        let at = |along: f64| [0, 1].map(|k| from[k] + (to[k] - from[k]) * along / length);
        fit(grey, at(start), at(end), band)
    };
    if length <= 2.0 * REACH_PX {
        let line = stretch(skip, length - skip)?;
        return Some((line, line));
    }
    Some((
        stretch(skip, skip + REACH_PX)?,
        stretch(length - skip - REACH_PX, length - skip)?,
    ))
}

/// How wide the bit cells along a side are across it, px: the smaller of its two ends.
fn cell_px(square: &Square, side: usize, cells: f64) -> f64 {
    let c = 1.0 / cells;
    let inwards = |along: f64| match side {
        0 => [(along, 0.0), (along, c)],
        1 => [(1.0, along), (1.0 - c, along)],
        2 => [(along, 1.0), (along, 1.0 - c)],
        _ => [(0.0, along), (c, along)],
    };
    let across = |along: f64| {
        let [on, inside] = inwards(along).map(|(u, v)| square.pixel(u, v));
        let [a, b] = [0.0, 1.0].map(|along| {
            let [(u, v), _] = inwards(along);
            square.pixel(u, v)
        });
        let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
        ((inside[0] - on[0]) * dy - (inside[1] - on[1]) * dx).abs() / dx.hypot(dy)
    };
    across(0.0).min(across(1.0))
}

/// A line through a point, px.
#[derive(Debug, Clone, Copy)]
struct Line {
    point: [f64; 2],
    direction: [f64; 2],
}

impl Line {
    /// Where two lines cross; `None` when they are almost parallel.
    fn meets(&self, other: &Line) -> Option<[f64; 2]> {
        let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
        let sine = cross(self.direction, other.direction);
        let between = [other.point[0] - self.point[0], other.point[1] - self.point[1]];
        let along = cross(between, other.direction) / sine;
        let at = [0, 1].map(|k| self.point[k] + along * self.direction[k]);
        (sine.abs() > 0.05 && at.iter().all(|v| v.is_finite())).then_some(at)
    }
}

/// The edge between two points near it. The inside of the tag lies to the right of the way from the first to the second.
fn fit(grey: &GrayImage, from: [f64; 2], to: [f64; 2], band: f64) -> Option<Line> {
    let length = distance(from, to);
    let direction = [0, 1].map(|k| (to[k] - from[k]) / length);
    let middle = [0, 1].map(|k| (to[k] + from[k]) / 2.0);
    let normal = [-direction[1], direction[0]];
    let samples = samples(grey, middle, direction, length / 2.0, band)?;
    let Edge { offset, slope } = edge::fit(&samples, band)?;
    // The edge is at `offset + slope · along` across the first guess, `along` in half lengths.
    let turn = slope / (length / 2.0);
    let norm = turn.hypot(1.0);
    Some(Line {
        point: [0, 1].map(|k| middle[k] + offset * normal[k]),
        direction: [0, 1].map(|k| (direction[k] + turn * normal[k]) / norm),
    })
}

/// Every pixel of a band about a stretch; `None` when the band leaves the picture.
fn samples(grey: &GrayImage, middle: [f64; 2], direction: [f64; 2], half: f64, band: f64) -> Option<Vec<Sample>> {
    // Walk along the axis the edge is nearer to, and across it over the pixels of the band.
    let (main, other) = if direction[0].abs() >= direction[1].abs() { (0, 1) } else { (1, 0) };
    let steep = direction[other] / direction[main];
    let spread = band / direction[main].abs();
    let reach = half * direction[main].abs();
    let (first, last) = ((middle[main] - reach).ceil() as i64, (middle[main] + reach).floor() as i64);
    let mut samples = Vec::with_capacity(((last - first + 1).max(0) as f64 * (2.0 * spread + 1.0)) as usize);
    let size = [i64::from(grey.width()), i64::from(grey.height())];
    for m in first..=last {
        let centre = middle[other] + (m as f64 - middle[main]) * steep;
        for o in (centre - spread).ceil() as i64..=(centre + spread).floor() as i64 {
            if m < 0 || o < 0 || m >= size[main] || o >= size[other] {
                return None;
            }
            let (x, y) = if main == 0 { (m, o) } else { (o, m) };
            let (dx, dy) = (x as f64 - middle[0], y as f64 - middle[1]);
            samples.push(Sample {
                along: (dx * direction[0] + dy * direction[1]) / half,
                across: dy * direction[0] - dx * direction[1],
                level: grey.get_pixel(x as u32, y as u32).0[0],
            });
        }
    }
    Some(samples)
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

fn shortest_side(corners: &[[f64; 2]; 4]) -> f64 {
    (0..4)
        .map(|i| distance(corners[i], corners[(i + 1) % 4]))
        .fold(f64::INFINITY, f64::min)
}
