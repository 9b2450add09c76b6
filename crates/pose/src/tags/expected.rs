//! Search for tags at predicted positions: knowing id and place, it finds smaller and more blurred tags than a search of the whole image.

use image::GrayImage;

use super::TagImage;
use super::border;
use super::fit::TagFit;
use super::likeness::{CellPattern, Corners, Likeness};
use super::missing::ExpectedTag;
use super::part::Part;
use super::refine::{self, TagSides};
use super::search::Found;
use super::seen::shortest_side_px;
use scaleproof_photo::Luma;

/// Maximum offset from the predicted position, in steps of half a bit cell.
const REACH_HALF_CELLS: usize = 5;

/// Minimum correlation of a tag's code with the pixels. Another tag of 36h11 differs in 11 of 36 bits, so it has at most 0.39.
const LEAST_CODE: f64 = 0.7;
const LEAST_ALL: f64 = 0.6;

/// Minimum size of a legible bit cell.
const LEAST_CELL_PX: f64 = 1.5;

/// Returns the tag at its predicted position, or nearby, if its code matches and its sides are visible.
pub(super) fn look(luma: &dyn Luma, expected: &ExpectedTag) -> Option<TagFit> {
    let tag = TagImage::new(expected.family, expected.id)?;
    let cells = expected.family.cells_across();
    let pattern = CellPattern::new(&tag);
    // Reach is counted in the larger cells: far corners of a tag seen at a slant have smaller cells than near ones.
    let reach = (REACH_HALF_CELLS as f64 / 2.0 + refine::REACH.0, refine::REACH.1);
    let part = Part::around(luma, &expected.corners_px, cells, reach);
    let (grey, place) = (&part.pixels, part.inside(&expected.corners_px));
    let (outline, corners_px) = confirmed(grey, &place, &pattern, cells).or_else(|| {
        let near = most_alike(grey, &place, &pattern, cells)?;
        confirmed(grey, &near, &pattern, cells)
    })?;
    let found = Found {
        family: expected.family,
        id: expected.id,
        corners_px: part.in_image(&corners_px),
    };
    Some(TagFit::with(found, part, Some(outline)))
}

/// Fits the sides near a position and returns them with their corners, if the code between them matches.
fn confirmed(grey: &GrayImage, corners_px: &Corners, pattern: &CellPattern, cells: f64) -> Option<(TagSides, Corners)> {
    let outline = refine::outline(grey, corners_px, cells)?;
    let fitted = outline.corners(0.0)?;
    let Likeness { of_all, of_code } = pattern.likeness(grey, &fitted)?;
    let is_tag = of_all >= LEAST_ALL && of_code >= LEAST_CODE;
    (is_tag && border::is_whole(grey, &fitted, cells)).then_some((outline, fitted))
}

/// Returns the position within reach that correlates best with the tag.
fn most_alike(grey: &GrayImage, corners_px: &Corners, pattern: &CellPattern, cells: f64) -> Option<Corners> {
    let cell_px = shortest_side_px(corners_px) / cells;
    if cell_px.is_nan() || cell_px < LEAST_CELL_PX {
        return None;
    }
    let (place, most) = pattern.most_alike(grey, corners_px, REACH_HALF_CELLS)?;
    (most >= LEAST_ALL / 2.0).then_some(place)
}
