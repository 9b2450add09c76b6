//! Areas of each paint on a piece: the cells of a world-aligned pattern, clipped to every triangle and flattened with it.

use crate::pieces::flat::Piece;
use scaleproof_core::geometry::clip::{self, clipped};
use scaleproof_core::geometry::{Point2, between as mix, distance, extent, to_segment};
use scaleproof_print::paint::plane::{Area, PlaneOutline, PlanePoint, edges, point, units};
use scaleproof_print::raster::FlatTriangle;
use scaleproof_print::wrap::{Contour, Region};
use scaleproof_surface::mesh::Mesh;
use scaleproof_surface::pattern::palette::Painted;
use scaleproof_surface::texture::{SurfacePoint, Tile};

/// Distance below which separately rounded parts of triangles are joined. Units: 0.4 µm.
const JOINED: i32 = 4;
/// Distance from a straight line below which corners are left out: 10 µm.
const STRAIGHT: f64 = 100.0;
/// Area below which parts are rounding, mm².
const NOTHING_MM2: f64 = 0.002;

/// Rotation about the origin of a piece's plane that turns most cells upright.
#[derive(Debug, Clone, Copy)]
pub struct Upright {
    /// Cosine and sine of the angle.
    turn: Point2,
}

impl Upright {
    /// Rotates a point of the piece's plane, and converts it to units.
    pub fn units(&self, [x, y]: Point2) -> PlanePoint {
        let [c, s] = self.turn;
        PlanePoint::new(units(c * x - s * y), units(s * x + c * y))
    }

    /// Rotates a point back to the piece's plane.
    pub fn back(&self, [x, y]: Point2) -> Point2 {
        let [c, s] = self.turn;
        [c * x + s * y, c * y - s * x]
    }

    /// Rotates a region of the piece's plane.
    pub fn area(&self, region: &Region) -> Area {
        let outline = |contour: &Contour| contour.iter().map(|p| self.units(*p)).collect();
        let outlines: Vec<PlaneOutline> = region.contours().map(outline).collect();
        smooth(&Area::of(&outlines))
    }
}

#[derive(Debug, Clone)]
pub struct PaintedPiece {
    pub upright: Upright,
    /// Area of each paint, turned upright. They share only borders.
    pub areas: Vec<Area>,
}

/// Corner of a part of a triangle: in the pattern's plane, in cells, rows counted downwards; and on paper.
#[derive(Debug, Clone, Copy)]
struct Corner {
    cell: Point2,
    flat: Point2,
}

impl clip::Corner for Corner {
    fn along(self, end: Self, share: f64) -> Self {
        Self {
            cell: mix(self.cell, end.cell, share),
            flat: mix(self.flat, end.flat, share),
        }
    }
}

pub fn painted_piece((mesh, tile): (&Mesh, &Tile), painted: &Painted, piece: &Piece) -> PaintedPiece {
    let laid: Vec<[Corner; 3]> = piece.triangles.iter().map(|t| corners(mesh, tile, t)).collect();
    let upright = Upright { turn: turn(&laid) };
    let mut parts: Vec<Vec<PlaneOutline>> = vec![Vec::new(); painted.paints.len()];
    for triangle in &laid {
        for row in cells(triangle, 1) {
            let strip = between(triangle, 1, row);
            for column in cells(&strip, 0) {
                let part = between(&strip, 0, column);
                let repeated = |i: f64, count: u32| i.rem_euclid(f64::from(count)) as usize;
                let [columns, rows] = [tile.pattern.columns(), tile.pattern.rows()];
                let paint = painted.paint_at(repeated(column, columns), repeated(row, rows));
                parts[paint].extend(outline(&part, &upright));
            }
        }
    }
    PaintedPiece {
        upright,
        areas: parts.iter().map(|parts| smooth(&joined(parts))).collect(),
    }
}

fn corners(mesh: &Mesh, tile: &Tile, flat: &FlatTriangle) -> [Corner; 3] {
    [0, 1, 2].map(|i| {
        let at = SurfacePoint {
            triangle: flat.triangle,
            weights: flat.weights[i],
        };
        let [u, v] = tile.plane_mm(mesh, &at);
        Corner {
            cell: [u / tile.cell_mm, -v / tile.cell_mm],
            flat: flat.flat_mm[i],
        }
    })
}

/// Returns the rotation that aligns the rows of cells with x or y, averaged over all triangles by area. Quarter turns are equivalent, so four times
/// the angle is averaged.
fn turn(laid: &[[Corner; 3]]) -> Point2 {
    let mut sum = [0.0; 2];
    for [a, b, c] in laid {
        let step = |p: &Corner, of: fn(&Corner) -> Point2| [0, 1].map(|axis| of(p)[axis] - of(a)[axis]);
        let (cell, flat) = (|p: &Corner| p.cell, |p: &Corner| p.flat);
        let ([du, dv], [eu, ev]) = (step(b, cell), step(c, cell));
        let (d, e) = (step(b, flat), step(c, flat));
        // Direction on paper of one step along the rows, not normalised.
        let whole = du * ev - dv * eu;
        let along = [0, 1].map(|axis| (ev * d[axis] - dv * e[axis]) * whole.signum());
        let area = (d[0] * e[1] - d[1] * e[0]).abs();
        let (s, c) = (4.0 * along[1].atan2(along[0])).sin_cos();
        (sum[0], sum[1]) = (sum[0] + area * c, sum[1] + area * s);
    }
    let angle = -0.25 * sum[1].atan2(sum[0]);
    [angle.cos(), angle.sin()]
}

/// Returns the rows (axis 1) or columns (0) that an outline reaches into.
fn cells(outline: &[Corner], axis: usize) -> impl Iterator<Item = f64> + use<> {
    let (low, high) = extent(outline.iter().map(|corner| corner.cell[axis]));
    let (first, end) = (low.floor(), high.ceil());
    // An outline without corners has none: minus infinity becomes 0.
    (0..(end - first) as usize).map(move |i| first + i as f64)
}

/// Clips a convex outline to one row or column.
fn between(outline: &[Corner], axis: usize, first: f64) -> Vec<Corner> {
    let rest = clipped(outline, |corner: &Corner| corner.cell[axis] - first);
    clipped(&rest, |corner| first + 1.0 - corner.cell[axis])
}

/// Returns a part of a triangle on paper, counter-clockwise; `None` if it is empty.
fn outline(part: &[Corner], upright: &Upright) -> Option<PlaneOutline> {
    let mut outline: PlaneOutline = part.iter().map(|corner| upright.units(corner.flat)).collect();
    let cross =
        |(a, b): (PlanePoint, PlanePoint)| i128::from(a.x) * i128::from(b.y) - i128::from(b.x) * i128::from(a.y);
    let doubled: i128 = edges(&outline).map(cross).sum();
    if doubled < 0 {
        outline.reverse();
    }
    (doubled != 0).then_some(outline)
}

/// Returns the union of parts without the slits that rounding left between them.
fn joined(parts: &[PlaneOutline]) -> Area {
    let grown = Area::of(parts).grown(JOINED);
    let mut area = grown.shrunk(JOINED);
    area.pieces.retain(|piece| Area::from_piece(piece).mm2() > NOTHING_MM2);
    area
}

/// Returns an area with fewer corners: its outlines are [`straightened`].
fn smooth(area: &Area) -> Area {
    let outlines: Vec<PlaneOutline> = area.outlines().map(straightened).filter(|o| o.len() > 2).collect();
    Area::of(&outlines)
}

/// Removes the corners of a closed outline that lie near the line between the remaining ones (Douglas & Peucker 1973).
fn straightened(outline: &PlaneOutline) -> PlaneOutline {
    let Some(first) = outline.first() else {
        return Vec::new();
    };
    let away = |i: usize| distance(point(outline[i]), point(*first));
    let farthest = (0..outline.len()).max_by(|a, b| away(*a).total_cmp(&away(*b)));
    let far = farthest.unwrap_or_default();
    let mut kept = vec![false; outline.len()];
    (kept[0], kept[far]) = (true, true);
    let at = |i: usize| point(outline[i % outline.len()]);
    let mut open = vec![(0, far), (far, outline.len())];
    while let Some((from, to)) = open.pop() {
        let between = (from + 1..to).map(|i| (i, to_segment(at(i), [at(from), at(to)])));
        if let Some((i, _)) = between
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .filter(|(_, off)| *off > STRAIGHT)
        {
            kept[i] = true;
            open.extend([(from, i), (i, to)]);
        }
    }
    (0..outline.len()).filter(|i| kept[*i]).map(|i| outline[i]).collect()
}
