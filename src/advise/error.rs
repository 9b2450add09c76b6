//! Why nothing can be advised.

use crate::camera::SizeError;
use crate::spelling::count;
use crate::tags::StartError;

/// Why nothing can be advised.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub(crate) enum AdviseError {
    #[error("the session has no photo")]
    NoPhoto,
    #[error("no photo of the session is located, so that there is nothing to compare{}", also(*disagreeing))]
    NothingLocated { disagreeing: usize },
    #[error(transparent)]
    Start(#[from] StartError),
    #[error("{file}: {fault}")]
    Size { file: String, fault: SizeError },
}

/// Why no photo is located, where tags say so.
fn also(disagreeing: usize) -> String {
    match disagreeing {
        0 => String::new(),
        _ => format!(
            "; the tags disagree with scene and camera in {}",
            count(disagreeing, "photo")
        ),
    }
}
