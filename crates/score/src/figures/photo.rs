//! Values of each photo, from which all tables are made.

use serde::Serialize;

use crate::error::ScoreError;
use crate::figures::PhotoOutcome;
use scaleproof_core::geometry::BoxPx;
use scaleproof_detect::Detection;
use scaleproof_photo::PerceptualHash;
use scaleproof_pose::locate::Sigma;
use scaleproof_pose::scene::{Bin, Viewpoint};
use scaleproof_session::Conditions;

/// A photo that was scored.
#[derive(Debug, Clone)]
pub struct ScoredPhoto {
    /// Number from 1, in the order of the sessions.
    pub id: u64,
    /// Index of its session in the run.
    pub session: usize,
    /// File, as the session names it.
    pub file: String,
    /// SHA-256 of the file, hex.
    pub sha256: String,
    /// The pattern on the model.
    pub variant: String,
    /// Place where it was taken.
    pub place: Option<String>,
    /// Conditions, as the session states them.
    pub conditions: Conditions,
    /// Width of the upright photo, px.
    pub width: u32,
    /// Height of the upright photo, px.
    pub height: u32,
    /// Viewpoint; absent only when the session gave the truth box and the tags gave no pose.
    pub viewpoint: Option<Viewpoint>,
    /// The bin of the viewpoint.
    pub bin: Option<Bin>,
    /// Ids of the tags behind the pose; empty when the session gave the viewpoint.
    pub tags: Vec<u32>,
    /// Corners of every tag that was seen, for the report.
    pub tag_marks: Vec<TagMark>,
    /// Reprojection error of the pose.
    pub rms_px: Option<f64>,
    /// Standard deviations of the viewpoint, where it follows from the pose.
    pub sigma: Option<Sigma>,
    /// Time when it was taken, as the session or EXIF says.
    pub taken: Option<String>,
    /// Exposure time, aperture and sensitivity, as EXIF says.
    pub exposure: Option<String>,
    /// The ground truth box.
    pub truth: BoxPx,
    /// True if the truth box came with the session instead of from the pose.
    pub truth_given: bool,
    /// Detections, one list per detector, best first.
    pub detections: Vec<Vec<Detection>>,
    /// Outcomes, one per detector.
    pub outcomes: Vec<PhotoOutcome>,
    /// A small JPEG for the report.
    pub preview_jpeg: Vec<u8>,
    /// Hash by which near-copies are found.
    pub hash: PerceptualHash,
    /// Number of near-copies that count with it, besides itself.
    pub near_copies: usize,
    /// Earlier photo of the run that shows the same moment, whichever place, direction and texture it is said to have.
    pub repeat_of: Option<String>,
}

/// Corners of a tag in a photo.
#[derive(Debug, Clone, PartialEq)]
pub struct TagMark {
    pub id: u32,
    pub corners_px: [[f64; 2]; 4],
    /// True if the pose rests on it.
    pub is_used: bool,
}

/// A photo that is in no figure or no difference: it could not be scored, or has no partner.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct NotScored {
    /// Name of the session's folder.
    pub session: String,
    /// As the session names it.
    pub file: String,
    /// The pattern on the model.
    pub variant: String,
    /// A sentence.
    pub reason: String,
    /// Of a near-copy, the file of the photo that it counts with.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub near_copy_of: Option<String>,
}

/// Returns the error of a run whose photos were all left out; none without any photo.
pub(crate) fn nothing_scored(photos: usize, first: Option<&NotScored>) -> Result<(), ScoreError> {
    let Some(NotScored { file, reason, .. }) = first.cloned() else {
        return Ok(());
    };
    Err(ScoreError::NothingScored { photos, file, reason })
}
