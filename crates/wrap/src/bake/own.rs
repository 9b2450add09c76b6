//! Whether a mesh's own texture coordinates can hold an image: every triangle has a place, and no two have the same.

use std::collections::HashMap;

use super::{BakedFace, WHOLE};
use scaleproof_surface::mesh::{Mesh, TextureCoordinates, doubled_area};

/// Overlaps are looked for in this many rows and columns.
const GRID: usize = 2048;
/// This share may lie on each other, or have no place: what exporters round.
const SLACK: f64 = 1e-3;
/// So far beyond the unit square is rounding.
const BEYOND: f64 = 1e-4;

/// Why a mesh's own coordinates hold no image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NotKept {
    Asked,
    Missing,
    Outside,
    /// Triangles with area have none in the image.
    NoArea,
    /// This share of the image that is used is used twice.
    Overlap(f64),
}

impl std::fmt::Display for NotKept {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Asked => f.write_str("as asked"),
            Self::Missing => f.write_str("as the mesh has no texture coordinates for all of it"),
            Self::Outside => f.write_str("as the mesh's own texture coordinates leave the image"),
            Self::NoArea => f.write_str("as the mesh's own texture coordinates give some of it no room"),
            Self::Overlap(share) => {
                let percent = (100.0 * share).max(0.1);
                write!(
                    f,
                    "as the mesh's own texture coordinates overlap (on {percent:.1} % of the image they use)"
                )
            }
        }
    }
}

/// The paint's triangles on the mesh's own coordinates, those together that hang together there.
pub(super) fn charts(mesh: &Mesh, paint: &[usize]) -> Result<Vec<Vec<BakedFace>>, NotKept> {
    let coordinates = paint.iter().map(|t| mesh.coordinates(*t));
    let uv = coordinates
        .collect::<Option<Vec<TextureCoordinates>>>()
        .ok_or(NotKept::Missing)?;
    let is_outside = |v: &f64| !(-BEYOND..=1.0 + BEYOND).contains(v);
    if uv.iter().flatten().flatten().any(is_outside) {
        return Err(NotKept::Outside);
    }
    check_room(mesh, paint, &uv)?;
    let overlap = overlap(&uv);
    if overlap > SLACK {
        return Err(NotKept::Overlap(overlap));
    }
    Ok(connected(mesh, paint, &uv))
}

fn check_room(mesh: &Mesh, paint: &[usize], uv: &[TextureCoordinates]) -> Result<(), NotKept> {
    let (mut all, mut without) = (0.0, 0.0);
    for (triangle, [a, b, c]) in paint.iter().zip(uv) {
        let mm2 = doubled_area(&mesh.corners_mm(&mesh.triangles()[*triangle])).norm();
        all += mm2;
        if cross(*a, *b, *c).abs() < 1e-12 {
            without += mm2;
        }
    }
    if without > SLACK * all {
        Err(NotKept::NoArea)
    } else {
        Ok(())
    }
}

/// The share of the used places of a grid that more than one triangle has inside.
fn overlap(uv: &[TextureCoordinates]) -> f64 {
    let mut times = vec![0_u8; GRID * GRID];
    for corners in uv {
        let [a, b, c] = corners.map(|p| p.map(|v| v * GRID as f64 - 0.5));
        let area = cross(a, b, c);
        if area == 0.0 {
            continue;
        }
        let span = |axis: usize| {
            let values = [a[axis], b[axis], c[axis]];
            let low = values.iter().copied().fold(f64::INFINITY, f64::min).ceil().max(0.0) as usize;
            let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max).floor() + 1.0;
            low..(high.max(0.0) as usize).min(GRID)
        };
        for y in span(1) {
            for x in span(0) {
                let p = [x as f64, y as f64];
                // Strictly inside, so that neighbours share no place.
                if [cross(b, c, p), cross(c, a, p), cross(a, b, p)]
                    .iter()
                    .all(|part| part / area > 1e-6)
                {
                    let count = &mut times[y * GRID + x];
                    *count = count.saturating_add(1);
                }
            }
        }
    }
    let used = times.iter().filter(|n| **n > 0).count();
    let twice = times.iter().filter(|n| **n > 1).count();
    twice as f64 / used.max(1) as f64
}

/// Triangles that share an edge of the mesh and its place in the image.
fn connected(mesh: &Mesh, paint: &[usize], uv: &[TextureCoordinates]) -> Vec<Vec<BakedFace>> {
    type Corner = (usize, [u32; 2]);
    let corner = |point: usize, uv: [f64; 2]| -> Corner { (point, uv.map(|v| (v as f32).to_bits())) };
    let mut first_at: HashMap<[Corner; 2], usize> = HashMap::new();
    let mut chart: Vec<usize> = (0..paint.len()).collect();
    for (i, (triangle, uv)) in paint.iter().zip(uv).enumerate() {
        let points = mesh.triangles()[*triangle].corners;
        for k in 0..3 {
            let next = (k + 1) % 3;
            let (p, q) = (corner(points[k], uv[k]), corner(points[next], uv[next]));
            let other = *first_at.entry([p.min(q), p.max(q)]).or_insert(i);
            let (a, b) = (root(&mut chart, i), root(&mut chart, other));
            chart[a.max(b)] = a.min(b);
        }
    }
    let mut place: HashMap<usize, usize> = HashMap::new();
    let mut charts: Vec<Vec<BakedFace>> = Vec::new();
    for (i, (triangle, uv)) in paint.iter().zip(uv).enumerate() {
        let next = charts.len();
        let at = *place.entry(root(&mut chart, i)).or_insert(next);
        if at == next {
            charts.push(Vec::new());
        }
        charts[at].push(BakedFace {
            triangle: *triangle,
            weights: WHOLE,
            uv: *uv,
        });
    }
    charts
}

/// The first of those that hang together with this one.
fn root(parent: &mut [usize], mut i: usize) -> usize {
    while parent[i] != i {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    i
}

/// Twice the signed area.
fn cross(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}
