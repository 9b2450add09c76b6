//! Test if a mesh's own texture coordinates can hold an image: every triangle has an area of its own.

use std::collections::HashMap;

use super::BakedFace;
use crate::unwrap::WHOLE;
use scaleproof_core::geometry::{PlaneTriangle, UnionFind, doubled_area};
use scaleproof_surface::mesh::{Mesh, TextureCoordinates};

/// Rows and columns of the grid used to find overlaps.
const GRID: usize = 2048;
/// Share that may overlap or have no area, due to exporters' rounding.
const SLACK: f64 = 1e-3;
/// Distance beyond the unit square that counts as rounding.
const BEYOND: f64 = 1e-4;

/// Reason why a mesh's own coordinates cannot hold an image.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum NotKept {
    #[error("as asked")]
    Asked,
    #[error("as the mesh has no texture coordinates for all of it")]
    Missing,
    #[error("as the mesh's own texture coordinates leave the image")]
    Outside,
    /// Some triangles with area have none in the image.
    #[error("as the mesh's own texture coordinates give some of it no room")]
    NoArea,
    /// Some of the used part of the image is used twice; this share of it.
    #[error("as the mesh's own texture coordinates overlap (on {:.1} % of the image they use)", (100.0 * .0).max(0.1))]
    Overlap(f64),
}

/// Returns the paint's triangles on the mesh's own coordinates, grouped into the parts connected there.
pub(super) fn charts(mesh: &Mesh, paint: &[usize]) -> Result<Vec<Vec<BakedFace>>, NotKept> {
    let coordinates = paint.iter().map(|t| mesh.coordinates(*t));
    let uv = coordinates
        .collect::<Option<Vec<TextureCoordinates>>>()
        .ok_or(NotKept::Missing)?;
    let is_outside = |v: &f64| !(-BEYOND..=1.0 + BEYOND).contains(v);
    if uv.iter().flatten().flatten().any(is_outside) {
        return Err(NotKept::Outside);
    }
    let (mut all, mut without) = (0.0, 0.0);
    for (triangle, [a, b, c]) in paint.iter().zip(&uv) {
        let mm2 = mesh.normal_mm2(*triangle).norm();
        all += mm2;
        if doubled_area(*a, *b, *c).abs() < 1e-12 {
            without += mm2;
        }
    }
    if without > SLACK * all {
        return Err(NotKept::NoArea);
    }
    let overlap = overlap(&uv);
    if overlap > SLACK {
        return Err(NotKept::Overlap(overlap));
    }
    Ok(connected(mesh, paint, &uv))
}

/// Returns the share of the used grid points that lie inside more than one triangle.
fn overlap(uv: &[TextureCoordinates]) -> f64 {
    let mut times = vec![0_u8; GRID * GRID];
    for corners in uv {
        let corners = corners.map(|p| p.map(|v| v * GRID as f64 - 0.5));
        let Some(triangle) = PlaneTriangle::new(corners) else {
            continue;
        };
        triangle.draw([GRID; 2], 0.0, |x, y, shares| {
            // Strictly inside, so that neighbours share no grid point.
            if shares.iter().all(|share| *share > 1e-6) {
                let count = &mut times[y * GRID + x];
                *count = count.saturating_add(1);
            }
        });
    }
    let used = times.iter().filter(|n| **n > 0).count();
    let twice = times.iter().filter(|n| **n > 1).count();
    twice as f64 / used.max(1) as f64
}

/// Groups triangles that share an edge of the mesh with equal coordinates in the image.
fn connected(mesh: &Mesh, paint: &[usize], uv: &[TextureCoordinates]) -> Vec<Vec<BakedFace>> {
    type Corner = (usize, [u32; 2]);
    let corner = |point: usize, uv: [f64; 2]| -> Corner { (point, uv.map(|v| (v as f32).to_bits())) };
    let mut first_at: HashMap<[Corner; 2], usize> = HashMap::new();
    let mut connected = UnionFind::new(paint.len());
    for (i, (triangle, uv)) in paint.iter().zip(uv).enumerate() {
        let points = mesh.triangles()[*triangle].corners;
        for k in 0..3 {
            let next = (k + 1) % 3;
            let (p, q) = (corner(points[k], uv[k]), corner(points[next], uv[next]));
            let other = *first_at.entry([p.min(q), p.max(q)]).or_insert(i);
            connected.unite(i, other);
        }
    }
    let mut place: HashMap<usize, usize> = HashMap::new();
    let mut charts: Vec<Vec<BakedFace>> = Vec::new();
    for (i, (triangle, uv)) in paint.iter().zip(uv).enumerate() {
        let next = charts.len();
        let at = *place.entry(connected.root(i)).or_insert(next);
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
