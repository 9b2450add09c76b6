//! Request for the tags of a scene.

use crate::media::Media;

#[derive(Debug, Clone, PartialEq)]
pub struct TagRequest {
    pub media: Media,
    /// True to print every tag as a plain card, regardless of its pose.
    pub plain: bool,
    /// True to draw the place of every tent card on the mat itself, regardless of the number of sheets.
    pub whole_mat: bool,
}
