//! Results of `survey`, as JSON and in words.

use schemars::JsonSchema;
use serde::Serialize;

use crate::cli::advice;
use scaleproof_pose::scene::TagFamily;
use scaleproof_rig::survey::{PhotoReport, Survey, TagReport};

/// `survey --json`.
#[derive(Serialize, JsonSchema)]
pub struct SurveyJson<'a> {
    /// Standard deviation of a corner coordinate, from the residuals.
    noise_px: f64,
    /// How far all tag edges were found too far in; taken out of the result.
    edge_shift_px: f64,
    /// How far the lens that the photos fit, and that was taken, moves a tag's corner at most from where the camera file has it; `null` where the file's fits.
    lens_px: Option<f64>,
    tags: &'a [TagReport],
    left_out: Vec<LeftOutJson>,
    /// In the order given.
    photos: &'a [PhotoReport],
}

/// A seen tag that is not in the scene.
#[derive(Serialize, JsonSchema)]
struct LeftOutJson {
    id: u32,
    family: TagFamily,
    /// Why the tag is not in the scene, as a word for programs (explained in codes.md).
    code: &'static str,
    /// Why the tag is not in the scene, as a sentence.
    reason: String,
}

pub fn json(found: &Survey) -> SurveyJson<'_> {
    let left_out = found.left_out.iter().map(|left| LeftOutJson {
        id: left.id,
        family: left.family,
        code: left.reason.code(),
        reason: advice::sentence(&left.reason),
    });
    SurveyJson {
        noise_px: found.noise_px,
        edge_shift_px: found.edge_shift_px,
        lens_px: found.lens_px,
        tags: &found.tags,
        left_out: left_out.collect(),
        photos: &found.photos,
    }
}
