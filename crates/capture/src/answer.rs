//! Outcome of a frame, for the terminal, the page and programs.

use schemars::JsonSchema;
use serde::Serialize;

use super::advice::Advice;
use super::gates::Measures;
use super::guidance::Guidance;
use scaleproof_core::geometry::Rigid;
use scaleproof_pose::scene::{Bin, Viewpoint};
use scaleproof_pose::tags::SeenTag;

/// Outcome of a frame.
#[derive(Debug, Clone)]
pub struct FrameAnswer {
    /// Width and height of the upright frame; zeros when it could not be read.
    pub size_px: [u32; 2],
    pub viewpoint: Option<Viewpoint>,
    /// `T_camera_model`.
    pub pose: Option<Rigid>,
    pub measures: Measures,
    /// The name of the accepted photo and its target's index, or what to do.
    pub verdict: Result<(String, usize), Advice>,
    /// Cautions about the pose, as sentences.
    pub cautions: Vec<String>,
    /// The tags that were seen, in the upright frame.
    pub tags: Vec<SeenTag>,
}

/// One line of `--json` for a frame.
#[derive(Serialize, JsonSchema)]
pub struct FrameLine<'a> {
    frame: &'a str,
    /// `accepted` or `refused`.
    status: &'static str,
    /// The photo's name in the session.
    photo: Option<&'a str>,
    /// Bin that the accepted photo fills.
    bin: Option<Bin>,
    code: Option<&'static str>,
    advice: Option<String>,
    viewpoint: Option<Viewpoint>,
    gates: Measures,
}

impl FrameAnswer {
    /// Returns the line for programs about the frame of this name.
    pub fn line<'a>(&'a self, frame: &'a str, guidance: &Guidance) -> FrameLine<'a> {
        let (accepted, advice) = (self.verdict.as_ref().ok(), self.verdict.as_ref().err());
        FrameLine {
            frame,
            status: if accepted.is_some() { "accepted" } else { "refused" },
            photo: accepted.map(|(photo, _)| photo.as_str()),
            bin: accepted.map(|(_, target)| guidance.targets()[*target].bin),
            code: advice.map(Advice::code),
            advice: advice.map(Advice::to_string),
            viewpoint: self.viewpoint,
            gates: self.measures,
        }
    }

    /// Returns the outcome in a sentence.
    pub fn sentence(&self, guidance: &Guidance) -> String {
        match &self.verdict {
            Ok((photo, target)) => {
                let (target, (filled, all)) = (&guidance.targets()[*target], guidance.filled_of_all());
                format!("taken as {photo}, {target} ({filled} of {all})")
            }
            Err(advice) => advice.to_string(),
        }
    }
}
