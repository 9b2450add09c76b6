//! Faster and Mask R-CNN (ONNX zoo, torchvision) and torchvision's SSD and RetinaNet: boxes n×4 (x1 y1 x2 y2 in input
//! pixels), labels n, scores n; masks are not used. Source: the zoo's page on Faster R-CNN; torchvision's detection models.

use super::super::nms::CandidateBox;
use super::rows::Rows;
use super::{HeadError, Tensor, misfit};
use scaleproof_core::geometry::BoxPx;

pub(super) fn decode(outputs: &[Tensor], first_label: i64, labels: usize) -> Result<Vec<CandidateBox>, HeadError> {
    let rows = Rows::pick(outputs)
        .ok_or_else(|| misfit("rcnn", "boxes n×4, whole-number labels n, scores n".into(), outputs))?;
    rows.candidates(first_label, labels, BoxPx::from)
}
