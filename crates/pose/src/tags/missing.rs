//! Tags that a possible pose predicts and nobody has found yet.

use crate::scene::TagFamily;

/// Tag predicted by a possible pose.
#[derive(Debug, Clone, PartialEq)]
pub struct ExpectedTag {
    /// Family of the tag.
    pub family: TagFamily,
    /// Number of the tag in its family.
    pub id: u32,
    /// Pixel corners as in [`super::SeenTag`].
    pub corners_px: [[f64; 2]; 4],
    /// True if the tag faces the camera, unhidden, large and well inside the image: a search that misses it is incomplete.
    pub is_in_plain_view: bool,
}

/// Result of matching the tags found so far with the scene: what is still missing.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct StillMissing {
    /// True if they determine a pose without ambiguity.
    pub has_pose: bool,
    /// Tags not found yet that the pose predicts or, without one, each pose the tags allow.
    pub expected: Vec<ExpectedTag>,
}
