//! Cuts the paint of a mesh into few pieces of bounded stretch and flattens each one.
//!
//! The steps in order, one file each: the [`surface`] (corners welded, large triangles subdivided), what of it is [`visibility`] from outside,
//! its [`topology`], first [`clusters`] that are almost flat, and pieces made of them.

mod clusters;
mod stretch;
mod surface;
mod topology;

use nalgebra::Point3;

use crate::mesh::Mesh;

/// More triangles than this take minutes.
pub(crate) const MAX_TRIANGLES: usize = 200_000;

/// What pieces are asked for.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct UnwrapRequest {
    /// At most so many, and up to 3 % of the paint may be left out for it. `None`: as many as it takes, and no paint is left out.
    pub most_pieces: Option<usize>,
    /// The mean stretch over all pieces, by area, is at most this.
    pub mean_stretch: f64,
    /// The 99th percentile of the stretch over all pieces, by area, is at most this.
    pub stretch_99: f64,
    /// Each piece fits into a rectangle of this size, turned as it likes, mm; `None`: any size.
    pub fits_mm: Option<[f64; 2]>,
    /// Also flatten what cannot be seen from outside; otherwise it is left out.
    pub hidden_too: bool,
}

impl Default for UnwrapRequest {
    fn default() -> Self {
        Self {
            most_pieces: None,
            mean_stretch: 1.03,
            stretch_99: 1.2,
            fits_mm: None,
            hidden_too: false,
        }
    }
}

/// One triangle of a piece. A large triangle of the mesh is subdivided, so several faces may share it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FlatFace {
    /// Of the mesh.
    pub triangle: usize,
    /// The barycentric place of each corner in that triangle.
    pub weights: [[f64; 3]; 3],
    /// Into [`Unwrapped::points_mm`]: an edge has the same two indices on both sides of a seam.
    pub corners: [usize; 3],
    /// Seen from outside, counter-clockwise. A piece may be cut into itself: two faces of it that share an edge lie apart
    /// where these differ, and the edge is a seam, too.
    pub flat_mm: [[f64; 2]; 3],
    /// The larger of the largest singular value from surface to paper and of the inverse of the smallest; 1 or more.
    pub stretch: f64,
}

/// One piece.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Chart {
    pub faces: Vec<FlatFace>,
    pub surface_mm2: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum LeftOutReason {
    /// It cannot be seen from outside.
    Hidden,
    /// It has no area, or it is there twice.
    NoArea,
    /// Pieces beyond the number asked for, smallest first.
    TooSmall,
}

/// Paint that no piece has.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LeftOut {
    /// Of the mesh, each once, rising. A triangle that was subdivided may have other parts in pieces.
    pub triangles: Vec<usize>,
    pub surface_mm2: f64,
    pub reason: LeftOutReason,
}

/// The pieces and what they keep.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Unwrapped {
    /// Model frame.
    pub points_mm: Vec<Point3<f64>>,
    /// Largest first.
    pub charts: Vec<Chart>,
    /// One for each reason there is.
    pub left_out: Vec<LeftOut>,
    /// The paint that can be seen, in pieces or not; all paint where hidden paint is flattened, too.
    pub visible_mm2: f64,
    pub mean_stretch: f64,
    pub stretch_99: f64,
    pub largest_stretch: f64,
}

/// Why there are no pieces.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub(crate) enum UnwrapError {
    #[error("the mesh has no paint that can be seen; check the paint's name and which way is up")]
    NoPaint,
    #[error("the paint has {count} triangles and is cut into pieces up to {MAX_TRIANGLES}; simplify the mesh")]
    TooManyTriangles { count: usize },
    #[error(
        "the paint takes {needed} pieces of this size and stretch, and {most} are allowed; allow more pieces, more stretch or larger paper"
    )]
    TooFewPieces { most: usize, needed: usize },
    #[error("a stretch of {value} cannot be kept; 1.001 and more can")]
    BadStretch { value: f64 },
    #[error("pieces of {} × {} mm are too small for this model", size_mm[0], size_mm[1])]
    BadSize { size_mm: [f64; 2] },
}

/// Cuts the paint of these materials (all if there are none) into pieces and flattens each. `progress` hears the share that is done.
///
/// # Errors
/// Nothing to cut, too much of it, and bounds that cannot be kept.
pub(crate) fn unwrap(
    mesh: &Mesh,
    materials: &[usize],
    request: &UnwrapRequest,
    progress: &mut dyn FnMut(f64),
) -> Result<Unwrapped, UnwrapError> {
    check(request)?;
    let surface = surface::Surface::of(mesh, materials, request.fits_mm)?;
    let topology = topology::Topology::of(&surface);
    let clusters = clusters::grow(&surface, &topology, request);
    let charts: Vec<Chart> = clusters.iter().map(|faces| flat_chart(&surface, faces)).collect();
    progress(1.0);
    summary(surface, charts)
}

fn check(request: &UnwrapRequest) -> Result<(), UnwrapError> {
    for value in [request.mean_stretch, request.stretch_99] {
        if !(1.001..).contains(&value) {
            return Err(UnwrapError::BadStretch { value });
        }
    }
    match request.fits_mm {
        Some(size_mm) if size_mm.iter().any(|mm| !(1.0..1e6).contains(mm)) => Err(UnwrapError::BadSize { size_mm }),
        _ => Ok(()),
    }
}

/// The faces seen along the first one's normal.
fn flat_chart(surface: &surface::Surface, faces: &[usize]) -> Chart {
    let corners = surface.corners(faces[0]);
    let normal = crate::mesh::doubled_area(&corners).normalize();
    let x = (corners[1] - corners[0]).normalize();
    let y = normal.cross(&x);
    let face = |f: &usize| {
        let (face, corners) = (&surface.faces[*f], surface.corners(*f));
        let flat = corners.map(|p| nalgebra::Vector2::new(p.coords.dot(&x), p.coords.dot(&y)));
        FlatFace {
            triangle: face.triangle,
            weights: face.weights,
            corners: face.corners,
            flat_mm: flat.map(Into::into),
            stretch: stretch::stretch(stretch::singular_values(&stretch::laid(&corners), &flat)),
        }
    };
    Chart {
        faces: faces.iter().map(face).collect(),
        surface_mm2: faces.iter().map(|f| surface.area(*f)).sum(),
    }
}

fn summary(surface: surface::Surface, mut charts: Vec<Chart>) -> Result<Unwrapped, UnwrapError> {
    charts.sort_by(|a, b| b.surface_mm2.total_cmp(&a.surface_mm2));
    let mut left_out = Vec::new();
    if !surface.no_area.is_empty() {
        left_out.push(LeftOut {
            triangles: surface.no_area.clone(),
            surface_mm2: 0.0,
            reason: LeftOutReason::NoArea,
        });
    }
    let area = |f: &FlatFace| 0.5 * crate::mesh::doubled_area(&f.corners.map(|c| surface.points[c])).norm();
    let faces = charts.iter().flat_map(|c| &c.faces);
    let values: Vec<(f64, f64)> = faces.map(|f| (f.stretch, area(f))).collect();
    let visible_mm2: f64 = values.iter().map(|(_, area)| area).sum();
    if values.is_empty() {
        return Err(UnwrapError::NoPaint);
    }
    Ok(Unwrapped {
        mean_stretch: values.iter().map(|(s, area)| s * area).sum::<f64>() / visible_mm2,
        largest_stretch: values.iter().map(|(s, _)| *s).fold(1.0, f64::max),
        stretch_99: stretch::percentile(values, 0.99),
        points_mm: surface.points,
        charts,
        left_out,
        visible_mm2,
    })
}
