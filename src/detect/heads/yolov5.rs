//! YOLOv5, v6, v7, and YOLOX exported with its decoding: one tensor 1×n×(5 + labels), centre and size in input pixels,
//! score = objectness · label. Source: the YOLOv5 repository's `non_max_suppression`.

use super::{Anchor, Anchors, HeadError, Tensor, centred, misfit};

pub(super) fn anchors(outputs: &[Tensor], labels: usize) -> Result<Anchors, HeadError> {
    let row = 5 + labels;
    // Older exports also give the three grids the tensor was made from.
    let fits = |t: &Tensor| matches!(t.shape[..], [1, _, columns] if columns == row);
    let found = outputs.iter().enumerate().find(|(_, t)| fits(t));
    let (output, data) = found
        .and_then(|(i, t)| Some((i, t.floats()?)))
        .ok_or_else(|| misfit("yolov5", format!("1×n×{row}"), outputs))?;
    let anchors = data.chunks_exact(row).enumerate().map(|(i, o)| Anchor {
        b: centred([o[0], o[1], o[2], o[3]]),
        output,
        objectness: Some(i * row + 4),
        first_label: i * row + 5,
        label_step: 1,
    });
    Ok(Anchors::new(anchors.collect()))
}
