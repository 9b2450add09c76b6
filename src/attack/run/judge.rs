//! How often a pattern is still detected, by the surrogate renderer's images of the views held out. This guides; what
//! counts are images rendered or photos taken anew.

use serde::{Deserialize, Serialize};

use super::loss::{HIT_CONFIDENCE, HIT_IOU};
use super::view_set::ViewSet;
use super::{Augmentation, Rgb, RunError, together};
use crate::ap::{ImageBoxes, average_precision};
use crate::detect::{CandidateBox, SCORE_FLOOR, suppress};
use crate::geometry::BoxPx;
use crate::whitebox::{Prediction, WhiteBox, strongest};
use crate::workers;

/// Means over views and detectors.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct HeldOutFigures {
    pub views: usize,
    /// As `score` computes it by default.
    pub ap50: f64,
    /// Share of images with a box on the model (IoU ≥ 0.5) of confidence ≥ 0.5.
    pub hit_rate: f64,
    /// Of the most confident box on the model; 0 where there is none.
    pub mean_confidence: f64,
}

/// Judges cells (sRGB, 0 to 1).
///
/// # Errors
/// A detector that cannot look, or whose answer is not a number.
pub(crate) fn judge(
    view_set: &ViewSet,
    detectors: &[Box<dyn WhiteBox>],
    cells: &[Rgb],
) -> Result<HeldOutFigures, RunError> {
    judge_images(view_set, detectors, |view| {
        Ok(view_set.textured(view, cells, &Augmentation::NONE).augmented.image)
    })
}

/// Judges whatever is in the images of the views.
///
/// # Errors
/// Those of `image`, and of the detectors.
pub(crate) fn judge_images(
    view_set: &ViewSet,
    detectors: &[Box<dyn WhiteBox>],
    image: impl Fn(usize) -> Result<Vec<Rgb>, RunError> + Sync,
) -> Result<HeldOutFigures, RunError> {
    let views = view_set.judged();
    let (mut hits, mut sum) = (0, 0.0);
    let mut boxes: Vec<Vec<ImageBoxes>> = vec![Vec::new(); detectors.len()];
    let looked = together::on_each(workers::thread_count(), detectors, &views, |detectors, view| {
        let image = image(*view)?;
        let looks = detectors
            .iter()
            .map(|detector| predictions(view_set, *detector, (*view, &image)));
        looks.collect::<Result<Vec<_>, RunError>>()
    });
    for (view, looks) in views.iter().zip(looked?) {
        let outline = &view_set.views[*view].outline;
        for ((detector, predictions), boxes) in detectors.iter().zip(looks).zip(&mut boxes) {
            let confidence = strongest(&predictions, outline, HIT_IOU).map_or(0.0, |i| predictions[i].confidence);
            hits += usize::from(confidence >= HIT_CONFIDENCE);
            sum += confidence;
            boxes.push(ImageBoxes {
                truths: vec![*outline],
                detections: detections(&predictions, detector.nms_iou()),
                ..ImageBoxes::default()
            });
        }
    }
    let count = (views.len() * detectors.len()).max(1) as f64;
    let aps = boxes.iter().filter_map(|images| average_precision(images, HIT_IOU));
    Ok(HeldOutFigures {
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
pub(crate) fn confidence(
    view_set: &ViewSet,
    detector: &dyn WhiteBox,
    (view, image, outline): (usize, &[Rgb], &BoxPx),
    least_iou: f64,
) -> Result<f64, RunError> {
    let predictions = predictions(view_set, detector, (view, image))?;
    Ok(strongest(&predictions, outline, least_iou).map_or(0.0, |i| predictions[i].confidence))
}

/// What a detector says of an image, every confidence a number.
fn predictions(
    view_set: &ViewSet,
    detector: &dyn WhiteBox,
    (view, image): (usize, &[Rgb]),
) -> Result<Vec<Prediction>, RunError> {
    let name = || (detector.name().to_owned(), view_set.views[view].frame.name.clone());
    let predictions = detector.predictions(image, view_set.list.size_px).map_err(|reason| {
        let (detector, view) = name();
        let reason = Box::new(reason);
        RunError::ForwardPass { detector, view, reason }
    })?;
    match predictions.iter().all(|prediction| prediction.confidence.is_finite()) {
        true => Ok(predictions),
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
fn detections(predictions: &[Prediction], nms_iou: f64) -> Vec<(f64, BoxPx)> {
    let candidates = predictions
        .iter()
        .filter(|prediction| prediction.confidence >= SCORE_FLOOR);
    let candidates = candidates.map(|prediction| CandidateBox {
        label: 0,
        score: prediction.confidence,
        b: prediction.box_px,
    });
    suppress(candidates.collect(), nms_iou)
        .into_iter()
        .map(|kept| (kept.score, kept.b))
        .collect()
}
