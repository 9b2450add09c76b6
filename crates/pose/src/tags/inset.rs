//! By how much all dark areas of a tag look too small (or too large) in a photo.
//!
//! Blur mixes light, the camera's tone curve bends it, and an ink spreads on paper: each moves every edge between dark and light
//! by the same small distance. The ring of cells just inside the outline is one cell wide. Where the cell behind it has the other
//! tone, its far edge is seen too and moves the other way, so that the ring's width tells the distance, whatever its cause.

use image::GrayImage;

use super::{TagHomography, TagImage, refine};
use scaleproof_core::geometry::stretches;

/// Below so many pixels a cell, the blur of its other edge moves an edge too.
const MIN_CELL_PX: f64 = 4.0;

/// Fewer cells of far edge than this are a guess.
const MIN_CELLS: f64 = 3.0;

/// Share of a cell that is left out where the cells behind the ring change their tone.
const END_CELLS: f64 = 0.25;

/// Share of a cell kept on either side of the far edge.
const BAND_CELLS: f64 = 0.5;

/// More than this share of a cell is no blur but another image.
const MAX_CELLS: f64 = 0.25;

/// How far, px, the outline was found inside the true one. `None` for a tag that is too small to tell.
///
/// `corners_px`: the outline as fitted by [`refine::outline`].
pub(super) fn inset_px(grey: &GrayImage, corners_px: &[[f64; 2]; 4], tag: &TagImage) -> Option<f64> {
    let n = tag.border_modules() as f64;
    let homography = TagHomography::to(corners_px);
    let (mut weight, mut moved) = (0.0, 0.0);
    for side in 0..4 {
        let cell = refine::cell_px(&homography, side, n);
        if cell < MIN_CELL_PX {
            return None;
        }
        let differs = behind_the_ring(tag, side);
        for run in stretches(0..differs.len(), |cell| differs[*cell]) {
            // Both ends are a share of the side, from its first corner on.
            let at = |along: f64| homography.pixel_at(side, along / n, 1.0 / n);
            let (from, to) = (at(run.start as f64 + END_CELLS), at(run.end as f64 - END_CELLS));
            if let Some(offset) = refine::edge_offset(grey, from, to, BAND_CELLS * cell) {
                let cells_seen = run.len() as f64;
                weight += cells_seen;
                moved += cells_seen * offset;
            }
        }
    }
    if weight < MIN_CELLS {
        return None;
    }
    // The outline lies `inset` inwards, so the far edge is looked for (1 − 2 / n) · inset inwards; it lies `inset` outwards.
    let inset = -moved / weight / (2.0 - 2.0 / n);
    let cells = (0..4).map(|side| refine::cell_px(&homography, side, n));
    let smallest = cells.fold(f64::INFINITY, f64::min);
    (inset.abs() < MAX_CELLS * smallest).then_some(inset)
}

/// For each cell along a side: whether the cell behind the ring differs from the ring. The two end cells belong to the ring.
pub fn behind_the_ring(tag: &TagImage, side: usize) -> Vec<bool> {
    let (modules, n) = (tag.modules(), tag.border_modules());
    let first = (modules.side() - n) / 2;
    let at = |along: usize, depth: usize| {
        let (row, column) = match side {
            0 => (depth, along),
            1 => (along, n - 1 - depth),
            2 => (n - 1 - depth, n - 1 - along),
            _ => (n - 1 - along, depth),
        };
        modules.is_black(first + row, first + column)
    };
    let differs = |along| (1..n - 1).contains(&along) && at(along, 1) != at(along, 0);
    (0..n).map(differs).collect()
}
