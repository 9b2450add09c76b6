//! World-aligned projection: the pattern as the printed panels carry it, from the positions and sides of a frame's paint.

use super::{Grid, Projection};
use crate::{Frame, FrameSet, FramesError};
use scaleproof_surface::pattern::world_aligned::Side;

/// Error of a pattern's place: by the way it is laid on, or by a pose that is not quite the assumed one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Misplacement {
    /// Size of the pattern relative to its true size.
    pub size: f64,
    /// Turn of the pattern on each side, about the side's origin.
    pub turn_deg: f64,
    /// Shift of the paint in the image to the left and up, px.
    pub seen_off_px: [f64; 2],
    /// Turn of the paint about the image's middle.
    pub seen_turned_deg: f64,
}

impl Misplacement {
    pub const NONE: Self = Self {
        size: 1.0,
        turn_deg: 0.0,
        seen_off_px: [0.0, 0.0],
        seen_turned_deg: 0.0,
    };

    /// Converts (u, v) on a side, mm, to those of the pattern that is turned and of another size.
    fn on_side(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        let [u, v] = turned([u, v], self.turn_deg);
        [u / self.size, v / self.size]
    }

    /// Converts a place in the image to that in the image of the assumed pose, both in pixels; `size_px` is the image's.
    fn in_image(&self, place: [f64; 2], size_px: [f64; 2]) -> [f64; 2] {
        let middle = size_px.map(|px| 0.5 * px);
        let from_middle = turned([place[0] - middle[0], place[1] - middle[1]], self.seen_turned_deg);
        std::array::from_fn(|i| from_middle[i] + middle[i] + self.seen_off_px[i])
    }
}

fn turned([x, y]: [f64; 2], by_deg: f64) -> [f64; 2] {
    let (sin, cos) = by_deg.to_radians().sin_cos();
    [cos * x - sin * y, sin * x + cos * y]
}

/// Computes the projections for a frame, one for each of some misplacements; `None` for a frame without positions. Where a misplaced pose would see no
/// paint, the paint is taken from where it should be: the model itself stays in its place. `of_sides`: each side of the model has a square
/// pattern of its own, and they lie below each other in the grid, in the order of [`Side::ALL`].
pub fn project(
    set: &FrameSet,
    frame: &Frame,
    grid: &Grid,
    of_sides: bool,
    misplacements: &[Misplacement],
) -> Result<Option<Vec<Projection>>, FramesError> {
    let (Some(points), Some(about)) = (set.surface(frame)?, &set.list.positions) else {
        return Ok(None);
    };
    let [width, height] = set.list.size_px.map(|px| px as usize);
    let factor = about.factor as usize;
    // The finer image of the parts.
    let (columns, rows) = (width * factor, height * factor);
    let part = |misplacement: &Misplacement, x: usize, y: usize| {
        let own = &points[y * columns + x];
        own.side?;
        let part_px = |at: usize| (at as f64 + 0.5) / factor as f64;
        let [there_x, there_y] = misplacement.in_image([part_px(x), part_px(y)], set.list.size_px.map(f64::from));
        let index = |px: f64, count: usize| {
            let at = (px * factor as f64).floor();
            (0.0..count as f64).contains(&at).then_some(at as usize)
        };
        let there = index(there_x, columns).zip(index(there_y, rows));
        let there = there.map(|(x, y)| &points[y * columns + x]);
        let point = there.filter(|point| point.side.is_some()).unwrap_or(own);
        let side = point.side?;
        let place = in_cells(grid, misplacement.on_side(side.project(&point.place_mm.into())));
        Some(if of_sides { below(grid, side, place) } else { place })
    };
    let project = |misplacement: &Misplacement| {
        let inside = |x: usize, y: usize| {
            let parts = (0..factor * factor).map(move |i| (x * factor + i % factor, y * factor + i / factor));
            parts.filter_map(|(x, y)| part(misplacement, x, y)).collect()
        };
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        Projection::from_points(grid, pixels.map(|(x, y)| inside(x, y)))
    };
    Ok(Some(misplacements.iter().map(project).collect()))
}

/// Converts (u, v) of a side, mm, to columns and rows: the origin is that of [`scaleproof_surface::pattern::world_aligned`].
pub(super) fn in_cells(grid: &Grid, [u_mm, v_mm]: [f64; 2]) -> [f64; 2] {
    [u_mm / grid.cell_mm, -v_mm / grid.cell_mm]
}

/// Converts a place in the pattern of a side to that in the grid of all sides.
fn below(grid: &Grid, side: Side, [column, row]: [f64; 2]) -> [f64; 2] {
    let rows = f64::from(grid.rows / Side::ALL.len() as u32);
    // rem_euclid of a tiny negative number rounds up to the count itself.
    let inside = row.rem_euclid(rows);
    let inside = if inside < rows { inside } else { 0.0 };
    [column, inside + rows * f64::from(side as u8)]
}
