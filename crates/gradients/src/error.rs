//! Why a detector cannot be attacked through its own network.

use scaleproof_core::files::FileError;
use scaleproof_core::message::{Message, message};
use scaleproof_detect::ProgramError;

/// Error of a detector that cannot be differentiated.
#[derive(Debug, thiserror::Error)]
pub enum WhiteBoxError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Message(#[from] Message),
    #[error(transparent)]
    Program(#[from] ProgramError),
}

pub(crate) fn no_image(pixels: usize, [width, height]: [u32; 2]) -> Message {
    message!("{pixels} pixels are no image of {width} × {height}")
}
