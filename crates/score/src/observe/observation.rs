//! Observation of a photo: all that a run needs of its pixels.

use serde::{Deserialize, Serialize};

use scaleproof_detect::Detection;
use scaleproof_photo::{PerceptualHash, Photo};
use scaleproof_pose::tags::SeenTag;

/// All that a run needs of a photo's pixels. Poses, truth, hits and figures follow from it in no time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Observation {
    /// SHA-256 of the file, hex.
    pub sha256: String,
    /// Width of the upright photo, px.
    pub width: u32,
    pub height: u32,
    /// Degrees by which EXIF turned the photo clockwise.
    pub turned_deg: u32,
    /// Time when it was taken, as EXIF says.
    pub taken: Option<String>,
    pub exposure: Option<String>,
    /// Tags of the scene that were needed for its pose. Empty when the session says where the model is, unless that is checked by tags.
    pub tags: Vec<SeenTag>,
    /// Detections, one list per detector, best first.
    pub detections: Vec<Vec<Detection>>,
    /// A small JPEG for the report; empty when it shows other photos.
    pub preview_jpeg: Vec<u8>,
    /// Hash by which near-copies are found.
    pub hash: PerceptualHash,
}

impl Observation {
    /// Returns the observation of a photo's file before anything is searched.
    pub(crate) fn unseen(photo: &Photo) -> Observation {
        let shot = photo.shot();
        Observation {
            sha256: photo.sha256.clone(),
            width: photo.width,
            height: photo.height,
            turned_deg: photo.turned_deg,
            taken: shot.taken,
            exposure: shot.exposure,
            tags: Vec::new(),
            detections: Vec::new(),
            preview_jpeg: Vec::new(),
            hash: PerceptualHash::default(),
        }
    }
}

/// Reason why a photo is left out, as a sentence.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, thiserror::Error)]
#[error("{0}")]
pub struct NotScoredReason(pub(crate) String);

impl NotScoredReason {
    pub(crate) fn new(reason: impl ToString) -> NotScoredReason {
        NotScoredReason(reason.to_string())
    }
}
