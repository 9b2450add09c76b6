//! YOLOv5, v6, v7, and YOLOX exported with its decoding: one tensor 1×n×(5 + labels), centre and size in input pixels,
//! score = objectness · label. Source: the YOLOv5 repository's `non_max_suppression`.

use super::super::nms::Candidate;
use super::{Tensor, best, from_centre, misfit};

pub(super) fn decode(outputs: &[Tensor], labels: usize) -> Result<Vec<Candidate>, String> {
    let row = 5 + labels;
    // Older exports also give the three grids the tensor was made from.
    let data = outputs
        .iter()
        .find(|t| matches!(t.shape[..], [1, _, columns] if columns == row))
        .and_then(Tensor::floats)
        .ok_or_else(|| misfit("yolov5", format!("1×n×{row}"), outputs))?;
    let rows = data.chunks_exact(row).filter_map(|o| {
        let (label, score) = best(&o[5..]);
        from_centre(label, o[4] * score, [o[0], o[1], o[2], o[3]])
    });
    Ok(rows.collect())
}
