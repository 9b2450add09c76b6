//! World-aligned projection: the pattern as the printed panels carry it, from the positions and sides of a frame's paint.

use super::{Grid, Projection, Sampling};
use crate::frames::{Frame, FrameSet, FramesError};
use crate::pattern::world_aligned::Side;

/// The projection for a frame; `None` for a frame without positions. `of_sides`: each side of the model has a square pattern of its own, and they
/// lie below each other in the grid, in the order of [`Side::ALL`].
///
/// # Errors
/// Images that cannot be read.
pub(crate) fn project(
    set: &FrameSet,
    frame: &Frame,
    grid: &Grid,
    (sampling, of_sides): (Sampling, bool),
) -> Result<Option<Projection>, FramesError> {
    let (Some(points), Some(about)) = (set.surface(frame)?, &set.list.positions) else {
        return Ok(None);
    };
    let [width, height] = set.list.size_px.map(|px| px as usize);
    let factor = about.factor as usize;
    let inside = |x: usize, y: usize| {
        let parts = (0..factor * factor).map(move |i| (x * factor + i % factor, y * factor + i / factor));
        parts
            .filter_map(|(x, y)| {
                let point = &points[y * width * factor + x];
                let side = point.side?;
                let place = in_cells(grid, side.project(&point.place_mm.into()));
                Some(if of_sides { below(grid, side, place) } else { place })
            })
            .collect()
    };
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    Ok(Some(Projection::from_points(
        grid,
        sampling,
        pixels.map(|(x, y)| inside(x, y)),
    )))
}

/// (u, v) of a side in mm as columns and rows: the origin is that of [`crate::pattern::world_aligned`].
pub(super) fn in_cells(grid: &Grid, [u_mm, v_mm]: [f64; 2]) -> [f64; 2] {
    [u_mm / grid.cell_mm, -v_mm / grid.cell_mm]
}

/// A place in the pattern of a side, in the grid of all sides.
fn below(grid: &Grid, side: Side, [column, row]: [f64; 2]) -> [f64; 2] {
    let rows = f64::from(grid.rows / Side::ALL.len() as u32);
    // rem_euclid of a tiny negative number rounds up to the count itself.
    let inside = row.rem_euclid(rows);
    let inside = if inside < rows { inside } else { 0.0 };
    [column, inside + rows * f64::from(side as u8)]
}
