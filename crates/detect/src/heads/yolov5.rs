//! YOLOv5, v6, v7, and YOLOX exported with its decoding: one tensor 1×n×(5 + labels), centre and size in input pixels,
//! score = objectness · label. Source: the YOLOv5 repository's `non_max_suppression`.

use super::{Anchor, Anchors, HeadError, Tensor, centred, misfit};

pub(super) fn anchors(outputs: &[Tensor], labels: usize) -> Result<Anchors, HeadError> {
    let row = 5 + labels;
    // Older exports also give the three grids the tensor was made from.
    let (output, data) = Tensor::shaped(outputs, |shape| matches!(shape, [1, _, columns] if *columns == row))
        .ok_or_else(|| misfit("yolov5", format!("1×n×{row}"), outputs))?;
    let rows = data.chunks_exact(row).enumerate();
    let anchors = rows.map(|(i, o)| Anchor::in_row(centred([o[0], o[1], o[2], o[3]]), output, i * row + 5, true));
    Ok(Anchors::new(anchors.collect()))
}
