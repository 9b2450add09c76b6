//! SSD-ResNet34 of the ONNX zoo: boxes 1×n×4 (x1 y1 x2 y2 as shares of the input), labels 1×n, scores 1×n. Source: the zoo's
//! page on the model for the shapes; MLPerf's reference for the order (mlcommons/inference, `PostProcessCocoOnnx`, which swaps
//! each pair to read it as TensorFlow's y1 x1 y2 x2).

use super::super::nms::CandidateBox;
use super::rows::Rows;
use super::{HeadError, Tensor, misfit, scaled};
use scaleproof_core::geometry::BoxPx;

pub(super) fn decode(
    outputs: &[Tensor],
    size: [u32; 2],
    first_label: i64,
    labels: usize,
) -> Result<Vec<CandidateBox>, HeadError> {
    let rows = Rows::pick(outputs).ok_or_else(|| {
        misfit(
            "ssd_resnet34",
            "boxes 1×n×4, whole-number labels 1×n, scores 1×n".into(),
            outputs,
        )
    })?;
    rows.candidates(first_label, labels, |b| scaled(BoxPx::from(b), size))
}
