//! RT-DETR as Ultralytics exports it: one tensor 1×n×(4 + labels): centre and size as shares of the input, then the labels'
//! scores; no suppression needed. Source: Zhao et al. 2024 and the Ultralytics documentation.

use super::super::nms::CandidateBox;
use super::{HeadError, Tensor, best, from_centre, misfit};

pub(super) fn decode(
    outputs: &[Tensor],
    [width, height]: [u32; 2],
    labels: usize,
) -> Result<Vec<CandidateBox>, HeadError> {
    let row = 4 + labels;
    let (_, data) = Tensor::shaped(outputs, |shape| matches!(shape, [1, _, columns] if *columns == row))
        .ok_or_else(|| misfit("rtdetr", format!("1×n×{row}"), outputs))?;
    let (w, h) = (width as f32, height as f32);
    let rows = data.chunks_exact(row).filter_map(|o| {
        let (label, score) = best(o[4..].iter().copied());
        from_centre(label, score, [o[0] * w, o[1] * h, o[2] * w, o[3] * h])
    });
    Ok(rows.collect())
}
