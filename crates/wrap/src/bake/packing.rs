//! Packing of flat charts into an image at the largest scale that fits: each upright in its smallest rectangle, the highest first, each at the lowest
//! position on top of those placed before (Lévy et al. 2002, Least Squares Conformal Maps, section 4).

use super::{BakeError, BakedFace, FlatChart};
use scaleproof_core::geometry::extent;

/// Margin around each chart, as a share of the image's shorter side; at least one texel is free.
pub(super) const ROOM: f64 = 1.0 / 512.0;
/// Number of bisection steps for the scale.
const STEPS: usize = 7;
/// Upper and lower bound of the share of the image that charts fill.
const SHARES: (f64, f64) = (0.95, 0.02);

/// Packs charts into an image at the largest scale that fits; returns coordinates in the unit square.
pub(super) fn into_image(
    charts: &[FlatChart],
    [width, height]: [u32; 2],
    room: f64,
) -> Result<Vec<FlatChart>, BakeError> {
    let upright: Vec<FlatChart> = charts.iter().map(upright).collect();
    let area: f64 = upright.iter().flatten().map(BakedFace::texels).sum();
    let room = (f64::from(width.min(height)) * room).max(1.0);
    let scale_of = |share: f64| (share * f64::from(width) * f64::from(height) / area.max(1e-9)).sqrt();
    let (mut fits, mut too_large) = (scale_of(SHARES.1), scale_of(SHARES.0));
    let charts = charts.len();
    let too_small = BakeError::TooSmall { charts, width, height };
    let mut spots = placed(&upright, fits, room, [width, height]).ok_or(too_small)?;
    for _ in 0..STEPS {
        let scale = 0.5 * (fits + too_large);
        match placed(&upright, scale, room, [width, height]) {
            Some(found) => (fits, spots) = (scale, found),
            None => too_large = scale,
        }
    }
    let (width, height) = (f64::from(width), f64::from(height));
    let moved = |(mut chart, [right, up]): (FlatChart, [f64; 2])| {
        for point in chart.iter_mut().flat_map(|face| &mut face.uv) {
            *point = [(point[0] * fits + right) / width, (point[1] * fits + up) / height];
        }
        chart
    };
    Ok(upright.into_iter().zip(spots).map(moved).collect())
}

/// Rotates a chart so that its bounding box is smallest and upright, with the lower left corner at the origin.
fn upright(chart: &FlatChart) -> FlatChart {
    let points: Vec<[f64; 2]> = chart.iter().flat_map(|face| face.uv).collect();
    let turned = |p: &[f64; 2], [cos, sin]: [f64; 2]| [cos * p[0] + sin * p[1], cos * p[1] - sin * p[0]];
    let extents = |turn| [0, 1].map(|axis: usize| extent(points.iter().map(|p| turned(p, turn)[axis])));
    let size = |turn| extents(turn).map(|(low, high)| high - low);
    let mut best = [1.0, 0.0];
    // Steps of two degrees: finer ones gain nothing.
    for step in 1..45 {
        let (sin, cos) = (2.0 * f64::from(step)).to_radians().sin_cos();
        let (new, old) = (size([cos, sin]), size(best));
        if new[0] * new[1] < (1.0 - 1e-9) * old[0] * old[1] {
            best = [cos, sin];
        }
    }
    if let [wide, high] = size(best)
        && wide > high
    {
        best = [-best[1], best[0]];
    }
    let [(left, _), (bottom, _)] = extents(best);
    let mut chart = chart.clone();
    for point in chart.iter_mut().flat_map(|face| &mut face.uv) {
        let [x, y] = turned(point, best);
        *point = [x - left, y - bottom];
    }
    chart
}

/// Returns the vertical span of a chart in each column of texels: from, to.
fn profile(chart: &FlatChart, scale: f64, room: f64) -> Vec<[f64; 2]> {
    let points = chart.iter().flat_map(|face| face.uv);
    let right = points.map(|p| p[0] * scale).fold(0.0, f64::max);
    let columns = (right + 2.0 * room).ceil() as usize + 1;
    let mut spans = vec![[f64::INFINITY, f64::NEG_INFINITY]; columns];
    for face in chart {
        let corners = face.uv.map(|p| p.map(|v| v * scale + room));
        for i in 0..3 {
            cover(&mut spans, corners[i], corners[(i + 1) % 3], room);
        }
    }
    spans
}

/// Adds an edge with room around it to the spans.
fn cover(spans: &mut [[f64; 2]], p: [f64; 2], q: [f64; 2], room: f64) {
    let (p, q) = if p[0] <= q[0] { (p, q) } else { (q, p) };
    let at = |x: f64| match q[0] - p[0] {
        run if run < 1e-9 => p[1],
        run => p[1] + (q[1] - p[1]) * ((x - p[0]) / run).clamp(0.0, 1.0),
    };
    let (first, last) = ((p[0] - room).floor().max(0.0) as usize, (q[0] + room).floor() as usize);
    for (column, span) in spans.iter_mut().enumerate().take(last + 1).skip(first) {
        // Part of the edge within the room of this column.
        let ends = [at(column as f64 - room), at(column as f64 + 1.0 + room)];
        let ends = if q[0] - p[0] < 1e-9 { [p[1], q[1]] } else { ends };
        span[0] = span[0].min(ends[0].min(ends[1]) - room);
        span[1] = span[1].max(ends[0].max(ends[1]) + room);
    }
}

/// Returns the offset of each chart, in texels; `None` if they do not fit.
fn placed(charts: &[FlatChart], scale: f64, room: f64, [width, height]: [u32; 2]) -> Option<Vec<[f64; 2]>> {
    let (width, height) = (width as usize, f64::from(height));
    let profiles: Vec<_> = charts.iter().map(|chart| profile(chart, scale, room)).collect();
    let high = |i: usize| profiles[i].iter().map(|span| span[1]).fold(0.0, f64::max);
    let mut order: Vec<usize> = (0..charts.len()).collect();
    order.sort_by(|a, b| high(*b).total_cmp(&high(*a)));
    let mut horizon = vec![0.0_f64; width];
    let mut spots = vec![[0.0; 2]; charts.len()];
    for i in order {
        let spans = &profiles[i];
        let (column, up) = lowest(&horizon, spans)?;
        for (ground, span) in horizon[column..].iter_mut().zip(spans) {
            *ground = ground.max(up + span[1]);
            if *ground > height {
                return None;
            }
        }
        spots[i] = [column as f64 + room, up + room];
    }
    Some(spots)
}

/// Returns the column at which a chart lies lowest on the charts below it, and its height there; `None` if it is too wide.
fn lowest(horizon: &[f64], spans: &[[f64; 2]]) -> Option<(usize, f64)> {
    let mut best: Option<(usize, f64)> = None;
    for column in 0..=horizon.len().checked_sub(spans.len())? {
        let mut up = 0.0_f64;
        for (ground, span) in horizon[column..].iter().zip(spans) {
            up = up.max(ground - span[0]);
            if best.is_some_and(|(_, low)| up >= low) {
                break;
            }
        }
        if best.is_none_or(|(_, low)| up < low) {
            best = Some((column, up));
        }
    }
    best
}
