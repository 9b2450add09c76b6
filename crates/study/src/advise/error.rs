//! Reasons why nothing can be advised.

use scaleproof_core::spelling::count;
use scaleproof_pose::camera::SizeError;
use scaleproof_pose::tags::StartError;

/// Reason why nothing can be advised.
#[derive(Debug, thiserror::Error)]
pub enum AdviseError {
    #[error("the session has no photo")]
    NoPhoto,
    #[error("no photo of the session is located, so that there is nothing to compare{}", also(*disagreeing))]
    NothingLocated { disagreeing: usize },
    #[error(transparent)]
    Start(#[from] StartError),
    #[error("{file}: {fault}")]
    Size { file: String, fault: SizeError },
}

/// Returns the part of a sentence on photos whose tags disagree; empty without any.
fn also(disagreeing: usize) -> String {
    let photos = (disagreeing > 0).then(|| count(disagreeing, "photo"));
    photos.map_or(String::new(), |photos| {
        format!("; the tags disagree with scene and camera in {photos}")
    })
}
