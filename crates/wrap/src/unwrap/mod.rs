//! Cuts the paint of a mesh into few pieces of bounded stretch and flattens each one.
//!
//! The steps in order, one file each: the paint as a [`surface`] (corners welded, large triangles subdivided); its visible part ([`visibility`]);
//! adjacency of faces ([`topology`]); almost flat [`clusters`]; and gluing them ([`merge`]) as long as the union, laid flat ([`patch`]), keeps its
//! stretch, does not overlap and fits the paper ([`assembly`]). Gluing is cheapest first, so seams remain where they are needed: along creases and at
//! the surface's ends.

mod assembly;
mod borders;
mod clusters;
mod error;
mod left_out;
mod merge;
mod outline;
mod patch;
mod request;
mod surface;
mod topology;
mod visibility;

pub use error::{MAX_TRIANGLES, UnwrapError};

pub use left_out::{LeftOut, LeftOutReason};

pub(crate) use request::STRETCH;
pub use request::UnwrapRequest;

use nalgebra::Point3;

use assembly::{Assembly, Piece};
use surface::Surface;
pub(crate) use surface::WHOLE;

use scaleproof_surface::mesh::Mesh;

/// Triangle of a piece. A large triangle of the mesh is subdivided, so several faces may share it.
#[derive(Debug, Clone, PartialEq)]
pub struct FlatFace {
    /// Index of the triangle in the mesh.
    pub triangle: usize,
    /// Barycentric coordinates of each corner in that triangle.
    pub weights: [[f64; 3]; 3],
    /// Indices into [`Unwrapped::points_mm`]: an edge has the same two indices on both sides of a seam.
    pub corners: [usize; 3],
    /// Corners on paper, seen from outside, counter-clockwise. A piece may have slits: two of its faces that share an edge are apart if these differ,
    /// and the edge is a seam, too.
    pub flat_mm: [[f64; 2]; 3],
    /// Stretch: the larger of the largest singular value from surface to paper and of the inverse of the smallest; 1 or more.
    pub stretch: f64,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    pub faces: Vec<FlatFace>,
    pub surface_mm2: f64,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Unwrapped {
    /// Points in the model frame.
    pub points_mm: Vec<Point3<f64>>,
    /// Pieces, largest first.
    pub charts: Vec<Chart>,
    /// Paint left out, one entry per reason.
    pub left_out: Vec<LeftOut>,
    /// Visible paint, in pieces or not; all paint if hidden paint is flattened, too.
    pub visible_mm2: f64,
    pub mean_stretch: f64,
    pub stretch_99: f64,
    pub largest_stretch: f64,
}

impl Unwrapped {
    pub fn surface_mm2(&self) -> f64 {
        self.charts.iter().map(|chart| chart.surface_mm2).sum()
    }
}

/// Cuts the paint of these materials (all if there are none) into pieces and flattens each. `progress` is called with the share done.
pub fn unwrap(
    mesh: &Mesh,
    materials: &[usize],
    request: &UnwrapRequest,
    progress: &mut dyn FnMut(f64),
) -> Result<Unwrapped, UnwrapError> {
    check(request)?;
    let mut surface = Surface::new(mesh, materials, request.fits_mm)?;
    let mut left_out = Vec::new();
    let mut seen = visibility::seen(mesh, &surface);
    if !request.hidden_too {
        let is_visible = visibility::visible(&seen, &surface.neighbours(|_, _| true));
        left_out.extend(surface.left_out(&unmarked(&is_visible), LeftOutReason::Hidden));
        surface.keep(&is_visible);
        let is_kept = seen.into_iter().zip(is_visible);
        seen = is_kept.filter_map(|(seen, is)| is.then_some(seen)).collect();
    }
    let across = topology::oriented(&mut surface, &seen);
    let mut assembly = Assembly::new(&surface, &across, request);
    for cluster in clusters::grow(&surface, &across, request.fits_mm) {
        assembly.add_cluster(&cluster);
    }
    let has_piece: Vec<bool> = assembly.piece_of.iter().map(Option::is_some).collect();
    left_out.extend(surface.left_out(&unmarked(&has_piece), LeftOutReason::NoArea));
    let pieces = merge::pieces(&assembly, progress);
    progress(1.0);
    summary(surface, pieces, left_out, request)
}

/// Returns the faces that are not marked.
fn unmarked(marks: &[bool]) -> Vec<usize> {
    (0..marks.len()).filter(|f| !marks[*f]).collect()
}

fn check(request: &UnwrapRequest) -> Result<(), UnwrapError> {
    for value in [request.mean_stretch, request.stretch_99] {
        if !STRETCH.contains(&value) {
            return Err(UnwrapError::BadStretch { value });
        }
    }
    match request.fits_mm {
        Some(size_mm) if size_mm.iter().any(|mm| !(1.0..1e6).contains(mm)) => Err(UnwrapError::BadSize { size_mm }),
        _ => Ok(()),
    }
}

/// Sorts the pieces by area, drops the smallest as far as allowed, and computes stretch statistics.
fn summary(
    surface: Surface,
    mut pieces: Vec<Piece>,
    mut left_out: Vec<LeftOut>,
    request: &UnwrapRequest,
) -> Result<Unwrapped, UnwrapError> {
    pieces.sort_by(|a, b| b.sums.area.total_cmp(&a.sums.area).then(a.faces.cmp(&b.faces)));
    let visible_mm2: f64 = pieces.iter().map(|p| p.sums.area).sum();
    if pieces.is_empty() {
        return Err(UnwrapError::NoPaint);
    }
    if let Some(most) = request.most_pieces {
        let beyond = pieces.split_off(merge::needed(&pieces).max(most).min(pieces.len()));
        if pieces.len() > most {
            return Err(UnwrapError::TooFewPieces {
                most,
                needed: pieces.len(),
            });
        }
        let faces: Vec<usize> = beyond.into_iter().flat_map(|p| p.faces).collect();
        left_out.extend(surface.left_out(&faces, LeftOutReason::TooSmall));
    }
    let values = pieces.iter().flat_map(|p| p.faces.iter().zip(&p.stretch));
    let values: Vec<(f64, f64)> = values.map(|(f, stretch)| (*stretch, surface.area(*f))).collect();
    let covered: f64 = values.iter().map(|(_, area)| area).sum();
    Ok(Unwrapped {
        charts: pieces.into_iter().map(|p| chart(&surface, p)).collect(),
        left_out,
        visible_mm2,
        mean_stretch: values.iter().map(|(s, area)| s * area).sum::<f64>() / covered,
        largest_stretch: values.iter().map(|(s, _)| *s).fold(1.0, f64::max),
        stretch_99: percentile(values, 0.99),
        points_mm: surface.points,
    })
}

fn chart(surface: &Surface, piece: Piece) -> Chart {
    let parts = piece.faces.iter().zip(piece.flat).zip(piece.stretch);
    let faces = parts.map(|((f, flat), stretch)| {
        let face = &surface.faces[*f];
        FlatFace {
            triangle: face.triangle,
            weights: face.weights,
            corners: face.corners,
            flat_mm: flat.map(Into::into),
            stretch,
        }
    });
    Chart {
        faces: faces.collect(),
        surface_mm2: piece.sums.area,
    }
}

/// Returns the value that a share of the area does not exceed, from pairs of value and area.
fn percentile(mut values: Vec<(f64, f64)>, share: f64) -> f64 {
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    let total: f64 = values.iter().map(|(_, area)| area).sum();
    let mut below = 0.0;
    let reached = values.iter().find(|(_, area)| {
        below += area;
        below >= share * total
    });
    reached.or(values.last()).map_or(1.0, |(value, _)| *value)
}
