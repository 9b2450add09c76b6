//! Reasons why a photo gets no pose.

use super::lone_tag::LoneTag;
use crate::camera::SizeError;
use scaleproof_core::spelling::list;

/// Reason why a photo got no pose. Each variant is a sentence a photographer can act on.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Abstention {
    #[error("no tag is visible: move back or uncover the tags")]
    NoTags,
    /// No tag is found, or only part of one, in a blurred photo.
    #[error(
        "no tag can be read, and no edge in the photo is sharper than a blur of {blur_px:.0} px: hold still, let it focus, or give it more light"
    )]
    Blurred { blur_px: f64 },
    #[error(
        "no tag of this scene is visible for certain, only ids that are unknown or appear twice ({}): is this another scene, or is a copy in the photo?",
        list(ids)
    )]
    NoKnownTag { ids: Vec<u32> },
    #[error(
        "no pose puts every seen tag before the camera and inside the image its lens model covers: check the tag directions in the scene file and the distortion in the camera file"
    )]
    BehindCamera,
    #[error(
        "the tags disagree by {rms_px:.1} px (limit {limit_px:.1} px): was a card moved, or is this another camera?"
    )]
    HighResidual { rms_px: f64, limit_px: f64 },
    #[error(
        "the {tags} visible tags disagree, and no two thirds of them (three at least) agree: was a card moved, or is this another camera?"
    )]
    NoMajority { tags: usize },
    #[error(
        "the visible tags leave the azimuth uncertain by ±{sigma_deg:.1}°, and the next bin begins {edge_deg:.1}° away: let more tags, or nearer ones, be seen"
    )]
    Degenerate { sigma_deg: f64, edge_deg: f64 },
    #[error(
        "only tag {id} is visible and two poses explain it almost equally well (residuals {best_px:.2} and {rival_px:.2} px): let a second tag be seen"
    )]
    OneTagAmbiguous {
        id: u32,
        best_px: f64,
        rival_px: f64,
        lone: Box<LoneTag>,
    },
    #[error("only tag {id} is visible, seen straight on ({tilt_deg:.0}° of tilt): let a second tag be seen")]
    OneTagFrontal { id: u32, tilt_deg: f64, lone: Box<LoneTag> },
    #[error(
        "only tag {id} is visible, which leaves the azimuth uncertain by ±{sigma_deg:.1}°, and the next bin begins {edge_deg:.1}° away: let a second tag, or a nearer one, be seen"
    )]
    OneTagDegenerate {
        id: u32,
        sigma_deg: f64,
        edge_deg: f64,
        lone: Box<LoneTag>,
    },
    #[error(
        "only tag {id} is visible, and part of its border is covered or out of the photo, so that its corners cannot be trusted: let a second tag be seen"
    )]
    OneTagCovered { id: u32 },
    #[error(
        "only tag {id} is visible, and its pose puts the model outside the photo: was its card turned or exchanged? Let a second tag be seen"
    )]
    OneTagNoModel { id: u32 },
    #[error(
        "only tag {id} is visible, but its pose puts other tags in plain view too ({}), which are not seen: was its card turned or exchanged, or are they covered? Let a second tag be seen",
        list(missing)
    )]
    OneTagMissesOthers { id: u32, missing: Vec<u32> },
    #[error(
        "the corners of tag {id}, the only one visible, do not fit a square of its size ({rms_px:.1} px off, limit {limit_px:.1} px): is this another camera, or is the card bent?"
    )]
    OneTagBent { id: u32, rms_px: f64, limit_px: f64 },
    #[error(
        "two poses explain the {tags} visible tags almost equally well (residuals {best_px:.2} and {rival_px:.2} px): let more tags be seen"
    )]
    RivalPose { tags: usize, best_px: f64, rival_px: f64 },
    #[error(transparent)]
    WrongCameraSize(#[from] SizeError),
}

impl Abstention {
    /// Returns true if tags disagree with each other, the scene or the camera, rather than being too few.
    pub fn is_disagreement(&self) -> bool {
        self.code() == "high_residual"
    }

    /// Returns the poses and bins that a lone tag leaves open, if that is the reason.
    pub fn lone(&self) -> Option<&LoneTag> {
        use Abstention::{OneTagAmbiguous, OneTagDegenerate, OneTagFrontal};
        match self {
            OneTagAmbiguous { lone, .. } | OneTagFrontal { lone, .. } | OneTagDegenerate { lone, .. } => Some(lone),
            _ => None,
        }
    }

    /// Returns a stable name for programs.
    pub fn code(&self) -> &'static str {
        match self {
            Abstention::NoTags => "no_tags",
            Abstention::Blurred { .. } => "blurred",
            Abstention::NoKnownTag { .. } => "no_known_tag",
            Abstention::BehindCamera => "behind_camera",
            Abstention::HighResidual { .. } | Abstention::NoMajority { .. } | Abstention::OneTagBent { .. } => {
                "high_residual"
            }
            Abstention::Degenerate { .. } | Abstention::OneTagDegenerate { .. } => "degenerate",
            Abstention::OneTagAmbiguous { .. } => "one_tag_ambiguous",
            Abstention::OneTagFrontal { .. } => "one_tag_frontal",
            Abstention::OneTagCovered { .. } => "one_tag_covered",
            Abstention::OneTagNoModel { .. } | Abstention::OneTagMissesOthers { .. } => "one_tag_contradicted",
            Abstention::RivalPose { .. } => "rival_pose",
            Abstention::WrongCameraSize { .. } => "wrong_camera_size",
        }
    }
}
