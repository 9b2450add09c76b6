//! Reasons why a model or a photo has no ground truth box.

use scaleproof_core::message::Message;
use scaleproof_surface::mesh::MeshError;

/// Reason why a scene's envelope cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum EnvelopeError {
    #[error(transparent)]
    Mesh(#[from] MeshError),
    #[error(transparent)]
    Message(#[from] Message),
}

/// Reason why a photo with a pose has no ground truth box.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NoTruth {
    #[error("the camera is inside the model's box: step back")]
    InsideModel,
    #[error("part of the model is behind the camera or beyond the camera model: step back")]
    BeyondCamera,
    #[error("the model is not in the photo")]
    OutOfPhoto,
}
