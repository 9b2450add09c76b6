//! Tags looked for where they should be: a search that knows the id and the place sees smaller and more blurred ones than one that knows
//! neither.

use image::GrayImage;

use super::border;
use super::fit::TagFit;
use super::likeness::{CellPattern, Corners, Likeness};
use super::part::Part;
use super::refine::{self, TagSides};
use super::search::Found;
use super::{TagImage, shortest_side_px};
use crate::scene::TagFamily;
use scaleproof_photo::photo::Luma;

/// Where a tag should be, by a pose that may be right.
#[derive(Debug, Clone, PartialEq)]
pub struct ExpectedTag {
    /// Which code it is of.
    pub family: TagFamily,
    /// Its number in the family.
    pub id: u32,
    /// Pixel corners as in [`super::SeenTag`].
    pub corners_px: [[f64; 2]; 4],
    /// It faces the camera, unhidden, large and well inside the image: a search that misses it is not done.
    pub is_in_plain_view: bool,
}

/// What the tags found so far leave to be found.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct StillMissing {
    /// They make a pose that is beyond doubt.
    pub has_pose: bool,
    /// The tags that the pose, or else each pose they allow, expects where none was found.
    pub expected: Vec<ExpectedTag>,
}

/// How far from its place a tag is looked for, in steps of half a bit cell.
const REACH_HALF_CELLS: usize = 5;

/// A tag is believed where its code correlates at least so much with the pixels. Another tag of 36h11 has 11 of 36 bits otherwise, which is
/// 0.39 at most.
const LEAST_CODE: f64 = 0.7;
const LEAST_ALL: f64 = 0.6;

/// Smaller cells show no code.
const LEAST_CELL_PX: f64 = 1.5;

/// The tag at its place, or nearby, if its code is there and its sides are seen.
pub(super) fn look(luma: &dyn Luma, expected: &ExpectedTag) -> Option<TagFit> {
    let tag = TagImage::new(expected.family, expected.id)?;
    let cells = expected.family.cells_across();
    let pattern = CellPattern::new(&tag);
    // Far corners of a tag seen at a slant have smaller cells than near ones: reach is counted in the larger.
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

/// The corners fitted to the sides that are seen near a place, if the code is between them.
fn confirmed(grey: &GrayImage, corners_px: &Corners, pattern: &CellPattern, cells: f64) -> Option<(TagSides, Corners)> {
    let outline = refine::outline(grey, corners_px, cells)?;
    let fitted = outline.corners(0.0)?;
    let Likeness { of_all, of_code } = pattern.likeness(grey, &fitted)?;
    let is_tag = of_all >= LEAST_ALL && of_code >= LEAST_CODE;
    (is_tag && border::is_whole(grey, &fitted, cells)).then_some((outline, fitted))
}

/// The place within reach that looks most like the tag.
fn most_alike(grey: &GrayImage, corners_px: &Corners, pattern: &CellPattern, cells: f64) -> Option<Corners> {
    let cell_px = shortest_side_px(corners_px) / cells;
    if cell_px.is_nan() || cell_px < LEAST_CELL_PX {
        return None;
    }
    let (place, most) = pattern.most_alike(grey, corners_px, REACH_HALF_CELLS)?;
    (most >= LEAST_ALL / 2.0).then_some(place)
}
