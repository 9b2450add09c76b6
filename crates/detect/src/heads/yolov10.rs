//! YOLOv10, YOLO26 and other YOLOs that need no suppression: one tensor 1×n×6: x1 y1 x2 y2 in input pixels, score, label.
//! Source: Wang et al. 2024 and the Ultralytics documentation of its exports.

use super::super::nms::CandidateBox;
use super::rows::strange_label;
use super::{HeadError, SCORE_FLOOR, Tensor, from_corners, misfit};
use scaleproof_core::geometry::BoxPx;

pub(super) fn decode(outputs: &[Tensor], labels: usize) -> Result<Vec<CandidateBox>, HeadError> {
    let (_, data) = Tensor::shaped(outputs, |shape| matches!(shape, [1, _, 6]))
        .ok_or_else(|| misfit("yolov10", "1×n×6".into(), outputs))?;
    // Rows of padding have any label, and no score.
    let rows = data.chunks_exact(6).filter(|o| f64::from(o[4]) >= SCORE_FLOOR);
    let candidates = rows.map(|o| {
        let label = o[5].round();
        if !(0.0..labels as f32).contains(&label) {
            return Err(strange_label(label, labels));
        }
        let b = [o[0], o[1], o[2], o[3]].map(f64::from);
        Ok(from_corners(label as usize, o[4], BoxPx::from(b)))
    });
    let candidates: Result<Vec<_>, HeadError> = candidates.collect();
    Ok(candidates?.into_iter().flatten().collect())
}
