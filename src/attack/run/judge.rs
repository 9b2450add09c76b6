//! How often a pattern is still detected, by the renderer model's pictures of the views held out. This guides; what
//! counts are pictures rendered or taken anew.

use serde::{Deserialize, Serialize};

use super::loss::{HIT_CONFIDENCE, HIT_IOU, strongest};
use super::stage::Stage;
use super::{Draw, Rgb, RunError};
use crate::attack::white_box::WhiteBox;
use crate::geometry::BoxPx;

/// Means over views and detectors.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Judgement {
    pub views: usize,
    /// Share of pictures with a box on the model (IoU ≥ 0.5) of confidence ≥ 0.5.
    pub hit_rate: f64,
    /// Of the most confident box on the model; 0 where there is none.
    pub mean_confidence: f64,
}

/// Judges cells (sRGB, 0 to 1).
///
/// # Errors
/// A detector that cannot look, or whose answer is not a number.
pub fn judge(stage: &Stage, detectors: &[Box<dyn WhiteBox>], cells: &[Rgb]) -> Result<Judgement, RunError> {
    judge_pictures(stage, detectors, |view| {
        Ok(stage.lay(view, cells, &Draw::NONE).taken.picture)
    })
}

/// Judges whatever is in the pictures of the views.
///
/// # Errors
/// Those of `picture`, and of the detectors.
pub fn judge_pictures(
    stage: &Stage,
    detectors: &[Box<dyn WhiteBox>],
    picture: impl Fn(usize) -> Result<Vec<Rgb>, RunError>,
) -> Result<Judgement, RunError> {
    let views = stage.judged();
    let (mut hits, mut sum) = (0, 0.0);
    for view in &views {
        let picture = picture(*view)?;
        for detector in detectors {
            let confidence = confidence(
                stage,
                detector.as_ref(),
                (*view, &picture, &stage.views[*view].outline),
                HIT_IOU,
            )?;
            hits += usize::from(confidence >= HIT_CONFIDENCE);
            sum += confidence;
        }
    }
    let count = (views.len() * detectors.len()).max(1) as f64;
    Ok(Judgement {
        views: views.len(),
        hit_rate: hits as f64 / count,
        mean_confidence: sum / count,
    })
}

/// The highest confidence of a box that overlaps the model so much; 0 where there is none.
///
/// # Errors
/// A detector that cannot look, or whose answer is not a number.
pub fn confidence(
    stage: &Stage,
    detector: &dyn WhiteBox,
    (view, picture, outline): (usize, &[Rgb], &BoxPx),
    least_iou: f64,
) -> Result<f64, RunError> {
    let view = || stage.views[view].frame.name.clone();
    let claims = detector
        .claims(picture, stage.list.size_px)
        .map_err(|reason| RunError::Look {
            detector: detector.name().to_owned(),
            view: view(),
            reason,
        })?;
    let found = strongest(&claims, outline, least_iou).map_or(0.0, |i| claims[i].confidence);
    match found.is_finite() {
        true => Ok(found),
        false => Err(RunError::NotANumber {
            detector: detector.name().to_owned(),
            view: view(),
            step: 0,
        }),
    }
}
