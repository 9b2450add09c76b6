//! Why nothing can be advised.

use crate::camera::SizeError;
use crate::tags::StartError;

/// Why nothing can be advised.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub(crate) enum AdviseError {
    #[error("the session has no photo")]
    NoPhoto,
    #[error("no photo of the session is located, so that there is nothing to compare")]
    NothingLocated,
    #[error(transparent)]
    Start(#[from] StartError),
    #[error("{file}: {fault}")]
    Size { file: String, fault: SizeError },
}
