//! Matching of seen tags with the scene's, and reasons why some are ignored.

use std::fmt;

use nalgebra::Point3;
use serde::Serialize;

use super::Abstention;
use crate::scene::{Scene, Tag};
use crate::tags::SeenTag;

/// A tag that was seen but that the pose does not rest on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, schemars::JsonSchema)]
pub struct IgnoredTag {
    pub id: u32,
    pub why: Ignored,
}

/// Reason why a seen tag was not used (explained in codes.md). From `wrong_id` on, it is derived from the pose of the other tags.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Ignored {
    /// The scene has no tag of this family and id.
    NotInScene,
    /// The id is in the image twice: one is a copy or a ghost, and nothing tells which.
    SeenTwice,
    /// Part of its border is covered or out of the image, and enough whole tags remain.
    PartlyCovered,
    /// It stands where the scene has another tag.
    WrongId,
    /// Its corners are where they should be, but run the other way round.
    Mirrored,
    /// Its corners are where they should be, but start at another one.
    Turned,
    /// Three corners or all are nearly where they should be, but not as near as the other tags': cut, bent or half covered.
    CornerOff,
    /// It is somewhere else.
    Moved,
}

impl Ignored {
    /// Returns true if the reason is derived from the pose of the other tags.
    pub fn is_outlier(self) -> bool {
        self >= Ignored::WrongId
    }
}

impl fmt::Display for Ignored {
    /// Writes the predicate of a sentence whose subject is the tag.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Ignored::NotInScene => "is not in the scene",
            Ignored::SeenTwice => "is in the photo twice",
            Ignored::PartlyCovered => "is partly covered",
            Ignored::WrongId => "stands where the scene has another one",
            Ignored::Mirrored => "is printed in a mirror",
            Ignored::Turned => "is turned by a quarter or a half",
            Ignored::CornerOff => "has a corner that is not where the other tags expect it",
            Ignored::Moved => "is not where the scene has it",
        })
    }
}

/// Tag of the scene with the seen positions of its corners.
#[derive(Debug, Clone)]
pub(super) struct Match<'a> {
    pub tag: &'a Tag,
    pub corners_px: [[f64; 2]; 4],
    pub is_whole: bool,
    pub is_fitted: bool,
}

impl Match<'_> {
    /// Returns the tag's area in the image, px².
    pub(super) fn area_px(&self) -> f64 {
        area_px(&self.corners_px)
    }

    /// Returns the relative standard deviation of the tag's apparent size by errors that move all of its sides alike: blur, a covered border, and a
    /// library's own corners. Residuals show little of these.
    pub(super) fn off_alike(&self) -> f64 {
        let hidden = if self.is_whole { 0.0 } else { NOT_WHOLE };
        let unfitted = if self.is_fitted { 0.0 } else { 2.0 * NOT_FITTED_PX };
        hidden.hypot(unfitted / self.area_px().sqrt())
    }
}

/// Relative size error of tags whose border is not seen whole, and inward shift in px of sides that could not be fitted: root mean squares over tags
/// in spoiled copies of photos (`benches/pose_speed.sh`). Half of those not whole look at least 1.4 % too small.
const NOT_WHOLE: f64 = 0.023;
const NOT_FITTED_PX: f64 = 0.35;

/// Area of a quadrilateral, px² (shoelace formula).
pub fn area_px(c: &[[f64; 2]; 4]) -> f64 {
    let cross = |i: usize| c[i][0] * c[(i + 1) % 4][1] - c[(i + 1) % 4][0] * c[i][1];
    (0..4).map(cross).sum::<f64>().abs() / 2.0
}

/// Corresponding corners: model frame in mm, image in px; four per tag, in the tags' order.
pub(super) struct Corners {
    pub model_mm: Vec<Point3<f64>>,
    pub image_px: Vec<[f64; 2]>,
    /// Relative standard deviation of each tag's apparent size, by errors common to its sides.
    pub off_alike: Vec<f64>,
}

impl Corners {
    pub(super) fn new(matches: &[Match]) -> Corners {
        Corners {
            model_mm: matches.iter().flat_map(|m| m.tag.corners_mm()).collect(),
            image_px: matches.iter().flat_map(|m| m.corners_px).collect(),
            off_alike: matches.iter().map(Match::off_alike).collect(),
        }
    }
}

/// Returns the tags to use for the pose, and the ignored ones, by id.
///
/// An id seen twice is left out both times. A tag that is partly covered is left out when two whole ones remain.
pub(super) fn match_tags<'a>(
    seen: &[SeenTag],
    scene: &'a Scene,
) -> Result<(Vec<Match<'a>>, Vec<IgnoredTag>), Abstention> {
    let times = |tag: &SeenTag| seen.iter().filter(|t| (t.family, t.id) == (tag.family, tag.id)).count();
    let (mut matches, mut ignored) = (Vec::new(), Vec::new());
    for tag in seen {
        let mut ignore = |why| ignored.push(IgnoredTag { id: tag.id, why });
        match scene.tag(tag.family, tag.id) {
            None => ignore(Ignored::NotInScene),
            Some(_) if times(tag) > 1 => ignore(Ignored::SeenTwice),
            Some(known) => matches.push(Match {
                tag: known,
                corners_px: tag.corners_px,
                is_whole: tag.is_whole,
                is_fitted: tag.is_fitted,
            }),
        }
    }
    if matches.iter().filter(|m| m.is_whole).count() >= 2 {
        for covered in matches.extract_if(.., |m| !m.is_whole) {
            let (id, why) = (covered.tag.id, Ignored::PartlyCovered);
            ignored.push(IgnoredTag { id, why });
        }
    }
    ignored.sort_unstable();
    ignored.dedup();
    match (matches.is_empty(), ignored.is_empty()) {
        (true, true) => Err(Abstention::NoTags),
        (true, false) => {
            let ids = ignored.iter().map(|i| i.id).collect();
            Err(Abstention::NoKnownTag { ids })
        }
        (false, _) => Ok((matches, ignored)),
    }
}
