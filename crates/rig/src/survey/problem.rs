//! Reasons why there is no survey, or a tag is not in it: sentences that a photographer can act on.

use scaleproof_core::message::Message;

/// Reason why there is no survey at all.
#[derive(Debug, thiserror::Error)]
pub enum SurveyError {
    #[error(
        "two arrangements of the tags explain the photos almost equally well: take more photos, from different sides, or fix a second tag"
    )]
    TwoArrangements,
    #[error(transparent)]
    Message(#[from] Message),
}

/// Reason why a seen tag is not in the surveyed scene.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LeftOutReason {
    /// Neither the sizes nor the scene has it.
    #[error("no size is given for it")]
    NoSize,
    #[error("no photo shows it whole and only once: uncover it, remove copies")]
    NeverWhole,
    /// One photo does not exclude its other planar pose.
    #[error("only {photo} shows it, where two poses explain it: take another photo of it, from aside")]
    SeenOnce { photo: String },
    #[error(
        "was moved, or badly seen: it is about {mm:.0} mm elsewhere in {} than in {}",
        there.join(", "),
        here.join(", ")
    )]
    Moved {
        mm: f64,
        here: Vec<String>,
        there: Vec<String>,
    },
    #[error("has another size than stated: its corners fit {fits_mm:.1} mm, not {stated_mm} mm")]
    WrongSize { stated_mm: f64, fits_mm: f64 },
    #[error("two poses explain its corners almost equally well: take another photo of it, from a different side")]
    Ambiguous,
}

impl LeftOutReason {
    pub fn code(&self) -> &'static str {
        match self {
            LeftOutReason::NoSize => "no_size",
            LeftOutReason::NeverWhole => "never_whole",
            LeftOutReason::SeenOnce { .. } => "seen_once",
            LeftOutReason::Moved { .. } => "moved",
            LeftOutReason::WrongSize { .. } => "wrong_size",
            LeftOutReason::Ambiguous => "ambiguous",
        }
    }
}
