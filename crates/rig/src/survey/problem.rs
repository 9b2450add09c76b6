//! Reasons why there is no survey, or a tag is not in it: sentences that a photographer can act on.

use scaleproof_core::spelling::list;

/// Reason why there is no survey at all.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SurveyError {
    #[error(
        "only {photos} of the photos shows a tag of known size, and a survey compares photos: give at least two, from different sides"
    )]
    TooFewPhotos { photos: usize },
    #[error("no tag to survey is seen in any photo, only fixed ones or none")]
    NothingToSurvey,
    #[error(
        "no fixed tag (id {}) is seen whole in any photo, so that nothing ties the others to the model: take a photo that shows one",
        list(ids)
    )]
    NoFixedTag { ids: Vec<u32> },
    #[error(
        "the tags fall into groups that no photo connects ({}): take a photo that shows tags of two groups, for each gap",
        all.iter().map(|ids| list(ids)).collect::<Vec<_>>().join(" | ")
    )]
    Disconnected { all: Vec<Vec<u32>> },
    #[error(
        "two arrangements of the tags explain the photos almost equally well: take more photos, from different sides, or fix a second tag"
    )]
    TwoArrangements,
    #[error("the photos leave the place of some tag open: take more photos, from different sides")]
    Undetermined,
    #[error(
        "the tags disagree by {rms_px:.1} px (limit {limit_px:.1} px): is this another camera, are the sizes wrong, or were many tags moved?"
    )]
    Disagree { rms_px: f64, limit_px: f64 },
    #[error("fixed tag {id} {fault}, so that the others cannot be tied to it: put it right, or fix another tag")]
    FixedTag { id: u32, fault: String },
    #[error(
        "tag {id} is fixed but the scene does not say where it stands: add it to the scene file or fix another tag"
    )]
    FixedUnknown { id: u32 },
    #[error("tag {id} is fixed with {scene_mm} mm in the scene and given with {given_mm} mm")]
    TwoSizes { id: u32, scene_mm: f64, given_mm: f64 },
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
