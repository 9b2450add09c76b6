//! Apparent shrinkage (or growth) of all dark areas of a tag in a photo.
//!
//! Blur mixes light, the camera's tone curve distorts it, and ink spreads on paper: each moves every edge between dark and light by the same small
//! distance. The ring of cells just inside the outline is one cell wide. If the cell behind it has the other tone, its far edge is visible too and
//! moves the other way, so the ring's width gives the distance, regardless of the cause.

use image::GrayImage;

use super::{TagHomography, TagImage, refine};
use scaleproof_core::geometry::stretches;

/// Minimum pixels per cell; with fewer, the blur of one edge of the ring moves the other.
const MIN_CELL_PX: f64 = 4.0;

/// Minimum number of cells with a visible far edge.
const MIN_CELLS: f64 = 3.0;

/// Share of a cell left out at tone changes of the cells behind the ring.
const END_CELLS: f64 = 0.25;

/// Half width of the band about the far edge, as a share of a cell.
const BAND_CELLS: f64 = 0.5;

/// Maximum inset, as a share of a cell; more is not blur.
const MAX_CELLS: f64 = 0.25;

/// Returns the distance, px, of the found outline inside the true one. `None` for a tag that is too small to tell.
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
    // The outline lies `inset` too far inwards, so the far edge is searched (1 − 2 / n) · inset too far inwards; it appears `inset` too far outwards.
    let inset = -moved / weight / (2.0 - 2.0 / n);
    let cells = (0..4).map(|side| refine::cell_px(&homography, side, n));
    let smallest = cells.fold(f64::INFINITY, f64::min);
    (inset.abs() < MAX_CELLS * smallest).then_some(inset)
}

/// Returns, for each cell along a side, whether the cell behind the ring differs from the ring. The two end cells belong to the ring.
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
