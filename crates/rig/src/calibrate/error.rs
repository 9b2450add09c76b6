//! Reasons why photos give no camera, and cautions about one.

use scaleproof_core::message::{Message, message};

/// Reason why there is no camera. Each is a sentence a photographer can act on.
#[derive(Debug, thiserror::Error)]
pub enum CalibrationError {
    #[error(
        "all photos show the board from the same side (within {spread_deg:.0}°), which leaves the focal length open: tilt the board by 30° to 45° to the left, right, front and back"
    )]
    SameTilt { spread_deg: f64 },
    #[error("these photos leave the focal length open (±{percent} %): {advice}")]
    FocalOpen { percent: String, advice: &'static str },
    #[error(transparent)]
    Message(#[from] Message),
}

impl CalibrationError {
    /// Returns the error of photos that no model fits.
    pub(super) fn no_fit() -> CalibrationError {
        message!("no camera explains these photos: are they of one board, by one camera at one zoom?").into()
    }
}

/// Caution about a camera that was found, as a sentence.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, schemars::JsonSchema)]
#[serde(transparent)]
pub struct CalibrationCaution(pub String);
