//! How often a pattern is still detected, by the renderer model's pictures of the views held out. This guides; what
//! counts are pictures rendered or taken anew.

use serde::{Deserialize, Serialize};

use super::loss::{HIT_CONFIDENCE, HIT_IOU, strongest};
use super::stage::Stage;
use super::{Draw, Rgb, RunError};
use crate::ap::{ImageBoxes, average_precision};
use crate::detect::{CandidateBox, SCORE_FLOOR, suppress};
use crate::geometry::BoxPx;
use crate::whitebox::{Claim, WhiteBox};

/// Means over views and detectors.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Judgement {
    pub views: usize,
    /// As `score` reckons it by default.
    pub ap50: f64,
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
    let mut boxes: Vec<Vec<ImageBoxes>> = vec![Vec::new(); detectors.len()];
    for view in &views {
        let picture = picture(*view)?;
        let outline = &stage.views[*view].outline;
        for (detector, boxes) in detectors.iter().zip(&mut boxes) {
            let claims = claims(stage, detector.as_ref(), (*view, &picture))?;
            let confidence = strongest(&claims, outline, HIT_IOU).map_or(0.0, |i| claims[i].confidence);
            hits += usize::from(confidence >= HIT_CONFIDENCE);
            sum += confidence;
            boxes.push(ImageBoxes {
                truths: vec![*outline],
                detections: detections(&claims, detector.hides_from_iou()),
            });
        }
    }
    let count = (views.len() * detectors.len()).max(1) as f64;
    let aps = boxes.iter().filter_map(|images| average_precision(images, HIT_IOU));
    Ok(Judgement {
        views: views.len(),
        ap50: aps.map(|found| found.ap).sum::<f64>() / detectors.len().max(1) as f64,
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
    let claims = claims(stage, detector, (view, picture))?;
    Ok(strongest(&claims, outline, least_iou).map_or(0.0, |i| claims[i].confidence))
}

/// What a detector says of a picture, every confidence a number.
fn claims(stage: &Stage, detector: &dyn WhiteBox, (view, picture): (usize, &[Rgb])) -> Result<Vec<Claim>, RunError> {
    let name = || (detector.name().to_owned(), stage.views[view].frame.name.clone());
    let claims = detector.claims(picture, stage.list.size_px).map_err(|reason| {
        let (detector, view) = name();
        RunError::Look { detector, view, reason }
    })?;
    match claims.iter().all(|claim| claim.confidence.is_finite()) {
        true => Ok(claims),
        false => {
            let (detector, view) = name();
            Err(RunError::NotANumber {
                detector,
                view,
                step: 0,
            })
        }
    }
}

/// The boxes that scoring would see.
fn detections(claims: &[Claim], hides_from_iou: f64) -> Vec<(f64, BoxPx)> {
    let candidates = claims.iter().filter(|claim| claim.confidence >= SCORE_FLOOR);
    let candidates = candidates.map(|claim| CandidateBox {
        label: 0,
        score: claim.confidence,
        b: claim.box_px,
    });
    suppress(candidates.collect(), hides_from_iou)
        .into_iter()
        .map(|kept| (kept.score, kept.b))
        .collect()
}
