//! Corner refinement to a few hundredths of a pixel: each side's blurred edge is fitted to the full-size image, neighbours are intersected.
//!
//! Blur mixes *light*, not grey levels. In the sRGB encoding of a JPEG the half-way grey level of a blurred edge is 21 % of
//! the light, so that a detector that looks for it sees the dark square too small, all round. The fit is therefore made in
//! linear light.

use image::GrayImage;

use super::TagHomography;
use super::edge::{self, BandPixels, Edge, EdgeProfile};
use super::seen::shortest_side_px;
use scaleproof_core::geometry::distance;

/// Length of a fitted segment, px: enough for a precise line; longer ones cost time, and bend by lens distortion.
const REACH_PX: f64 = 64.0;

/// Maximum and minimum half width of the band of pixels about an edge.
const MAX_BAND_PX: f64 = 6.0;
const MIN_BAND_PX: f64 = 1.0;

/// Half width of the band in bit cells: the clean space on either side of an edge is one cell, less the next cell's blur.
const BAND_CELLS: f64 = 0.6;

/// Share of a cell left out at the ends of a side, where the neighbouring side's blur mixes in.
const END_CELLS: f64 = 0.5;

/// Reach of a fit around the given corners, in bit cells and px: the corners are within half a cell, move by one at most, and the ring outside them
/// is half a cell wide.
pub(super) const REACH: (f64, f64) = (2.0, MAX_BAND_PX);

/// Shift of a corner, px, above which the fit is repeated with a band centred on the new edge.
const CENTRED_PX: f64 = 0.25;
const MAX_ROUNDS: usize = 3;

/// Row step of the coarse first fit, and the side length, px, below which all rows are used.
const ROUGH_ROWS: usize = 4;
const ROUGH_PX: f64 = 24.0;

/// Lines of a tag's four sides: for each, near its first and near its second corner.
pub(super) struct TagSides([(EdgeLine, EdgeLine); 4]);

impl TagSides {
    /// Intersects the sides after moving each outwards, px; `None` if two are almost parallel.
    pub(super) fn corners(&self, outwards_px: f64) -> Option<[[f64; 2]; 4]> {
        let mut corners = [[0.0; 2]; 4];
        for (i, corner) in corners.iter_mut().enumerate() {
            let (before, after) = (self.0[(i + 3) % 4].1, self.0[i].0);
            *corner = before.moved(-outwards_px).meets(&after.moved(-outwards_px))?;
        }
        Some(corners)
    }

    /// Returns the blur of each side: standard deviations, px.
    pub(super) fn blurs_px(&self) -> [f64; 4] {
        self.0
            .map(|(first, second)| (first.profile.blur + second.profile.blur) / 2.0)
    }
}

/// Fits the sides to the image; `None` if one of them is not visible well enough.
///
/// `corners_px` must be within half a cell. `cells`: width of the outline in bit cells.
pub(super) fn outline(grey: &GrayImage, corners_px: &[[f64; 2]; 4], cells: f64) -> Option<TagSides> {
    let most_px = shortest_side_px(corners_px) / cells;
    let reached = |outline: &TagSides| {
        let corners = outline.corners(0.0)?;
        (furthest(corners_px, &corners) <= most_px).then_some(corners)
    };
    let (mut corners, mut guess) = (*corners_px, None);
    if let Some(rough) = sides(grey, corners_px, cells, ROUGH_ROWS, None)
        && let Some(found) = reached(&rough)
    {
        (corners, guess) = (found, Some(rough));
    }
    let mut round = 1;
    loop {
        let outline = sides(grey, &corners, cells, 1, guess.as_ref())?;
        let refined = reached(&outline)?;
        if furthest(&corners, &refined) < CENTRED_PX || round == MAX_ROUNDS {
            return Some(outline);
        }
        (corners, guess, round) = (refined, Some(outline), round + 1);
    }
}

/// Returns the largest distance between corresponding corners.
fn furthest(a: &[[f64; 2]; 4], b: &[[f64; 2]; 4]) -> f64 {
    (0..4).map(|i| distance(a[i], b[i])).fold(0.0, f64::max)
}

/// Fits the four sides once, to every `rows`-th row of pixels across them. `guess`: an earlier fit.
fn sides(
    grey: &GrayImage,
    corners: &[[f64; 2]; 4],
    cells: f64,
    rows: usize,
    guess: Option<&TagSides>,
) -> Option<TagSides> {
    let homography = TagHomography::to(corners);
    // A side's line near its first and near its second corner; the same one when the side is short.
    let lines_of = |side: usize| {
        let (from, to) = (corners[side], corners[(side + 1) % 4]);
        let length = distance(from, to);
        let band = (BAND_CELLS * cell_px(&homography, side, cells)).min(MAX_BAND_PX);
        let skip = END_CELLS * length / cells;
        if band < MIN_BAND_PX || length - 2.0 * skip < 4.0 {
            return None;
        }
        let guess = guess.map(|sides| &sides.0[side]);
        let (first, second) = guess.map(|(first, second)| (first.profile, second.profile)).unzip();
        let segment = |start: f64, end: f64, guess: Option<EdgeProfile>| {
            let at = |along: f64| [0, 1].map(|k| from[k] + (to[k] - from[k]) * along / length);
            EdgeSegment::between(at(start), at(end)).fit(grey, band, rows, guess)
        };
        if length <= 2.0 * REACH_PX {
            let line = segment(skip, length - skip, first)?;
            return Some((line, line));
        }
        let near_first = segment(skip, skip + REACH_PX, first)?;
        Some((near_first, segment(length - skip - REACH_PX, length - skip, second)?))
    };
    Some(TagSides([lines_of(0)?, lines_of(1)?, lines_of(2)?, lines_of(3)?]))
}

/// Returns the width of the bit cells along a side, measured across it, px: the smaller of its two ends.
pub(super) fn cell_px(homography: &TagHomography, side: usize, cells: f64) -> f64 {
    let [a, b] = [0.0, 1.0].map(|along| homography.pixel_at(side, along, 0.0));
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let across = |on: [f64; 2], along: f64| {
        let inside = homography.pixel_at(side, along, 1.0 / cells);
        ((inside[0] - on[0]) * dy - (inside[1] - on[1]) * dx).abs() / dx.hypot(dy)
    };
    across(a, 0.0).min(across(b, 1.0))
}

/// Returns the inward offset of an edge from the line between two points near it, px; `None` if no edge is visible in the band about it.
pub(super) fn edge_offset(grey: &GrayImage, from: [f64; 2], to: [f64; 2], band: f64) -> Option<f64> {
    let segment = EdgeSegment::between(from, to);
    Some(edge::fit(&segment.samples(grey, band, 1)?, band, None)?.offset)
}

/// Returns the blur of the edge between two points near it: the standard deviation in px, or infinity if no edge is visible in the band about the
/// line. `None` if the band leaves the image.
pub(super) fn edge_blur(grey: &GrayImage, from: [f64; 2], to: [f64; 2], band: f64) -> Option<f64> {
    let samples = EdgeSegment::between(from, to).samples(grey, band, 1)?;
    Some(edge::fit(&samples, band, None).map_or(f64::INFINITY, |edge| edge.profile.blur))
}

/// Line through a point, px, with the profile of its edge.
#[derive(Debug, Clone, Copy)]
struct EdgeLine {
    point: [f64; 2],
    direction: [f64; 2],
    profile: EdgeProfile,
}

impl EdgeLine {
    /// Returns the line moved inwards, px.
    fn moved(&self, inwards: f64) -> EdgeLine {
        let normal = inward_normal(self.direction);
        EdgeLine {
            point: [0, 1].map(|k| self.point[k] + inwards * normal[k]),
            ..*self
        }
    }

    /// Returns the intersection of two lines; `None` if they are almost parallel.
    fn meets(&self, other: &EdgeLine) -> Option<[f64; 2]> {
        let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
        let sine = cross(self.direction, other.direction);
        let between = [other.point[0] - self.point[0], other.point[1] - self.point[1]];
        let along = cross(between, other.direction) / sine;
        let at = [0, 1].map(|k| self.point[k] + along * self.direction[k]);
        (sine.abs() > 0.05 && at.iter().all(|v| v.is_finite())).then_some(at)
    }
}

/// Returns the normal towards the inside of the tag, to the right of the direction from corner to corner (y points down).
fn inward_normal(direction: [f64; 2]) -> [f64; 2] {
    [-direction[1], direction[0]]
}

/// Segment of a side: the first guess of an edge.
struct EdgeSegment {
    middle: [f64; 2],
    direction: [f64; 2],
    half: f64,
}

impl EdgeSegment {
    fn between(from: [f64; 2], to: [f64; 2]) -> EdgeSegment {
        let length = distance(from, to);
        EdgeSegment {
            middle: [0, 1].map(|k| (to[k] + from[k]) / 2.0),
            direction: [0, 1].map(|k| (to[k] - from[k]) / length),
            half: length / 2.0,
        }
    }

    fn fit(&self, grey: &GrayImage, band: f64, rows: usize, guess: Option<EdgeProfile>) -> Option<EdgeLine> {
        let rows = if 2.0 * self.half < ROUGH_PX { 1 } else { rows };
        let Edge { offset, slope, profile } = edge::fit(&self.samples(grey, band, rows)?, band, guess)?;
        let normal = inward_normal(self.direction);
        let turn = slope / self.half;
        let norm = turn.hypot(1.0);
        Some(EdgeLine {
            point: [0, 1].map(|k| self.middle[k] + offset * normal[k]),
            direction: [0, 1].map(|k| (self.direction[k] + turn * normal[k]) / norm),
            profile,
        })
    }

    /// Returns the pixels of a band about the segment, of every `rows`-th row across it; `None` if the band leaves the image.
    fn samples(&self, grey: &GrayImage, band: f64, rows: usize) -> Option<BandPixels> {
        let (middle, direction, half) = (self.middle, self.direction, self.half);
        // Walk along the axis the edge is nearer to, and across it over the pixels of the band.
        let main = usize::from(direction[0].abs() < direction[1].abs());
        let other = 1 - main;
        let steep = direction[other] / direction[main];
        let spread = band / direction[main].abs();
        let reach = half * direction[main].abs();
        let size = [f64::from(grey.width()), f64::from(grey.height())];
        let inside = |axis: usize, extent: f64| middle[axis] >= extent && middle[axis] + extent <= size[axis] - 1.0;
        if !inside(main, reach) || !inside(other, reach * steep.abs() + spread) {
            return None; // also when a number is not finite
        }
        let mut samples = BandPixels::default();
        let along = (middle[main] - reach).ceil() as u32..=(middle[main] + reach).floor() as u32;
        for m in along.step_by(rows) {
            let centre = middle[other] + (f64::from(m) - middle[main]) * steep;
            for o in (centre - spread).ceil() as u32..=(centre + spread).floor() as u32 {
                let (x, y) = if main == 0 { (m, o) } else { (o, m) };
                let (dx, dy) = (f64::from(x) - middle[0], f64::from(y) - middle[1]);
                let along = (dx * direction[0] + dy * direction[1]) / half;
                let across = dy * direction[0] - dx * direction[1];
                samples.push(along, across, grey.get_pixel(x, y).0[0]);
            }
        }
        Some(samples)
    }
}
