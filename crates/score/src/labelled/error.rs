//! Error of photos that a detector cannot be run on.

use scaleproof_detect::DetectError;
use scaleproof_photo::PhotoError;

#[derive(Debug, thiserror::Error)]
pub enum LabelledError {
    #[error(transparent)]
    Photo(#[from] PhotoError),
    #[error(transparent)]
    Detector(#[from] DetectError),
}
