//! YOLOv8, v9, 11, 12: one tensor 1×(4 + labels)×n, a column per box: centre and size in input pixels, then the labels'
//! scores; no objectness. Source: the Ultralytics documentation of its exports.

use super::{Anchor, Anchors, HeadError, Tensor, centred, misfit};

pub(super) fn anchors(outputs: &[Tensor], labels: usize) -> Result<Anchors, HeadError> {
    let rows = 4 + labels;
    let (output, data, columns) = (outputs.iter().enumerate())
        .find_map(|(i, t)| match t.shape[..] {
            [1, r, columns] if r == rows => Some((i, t.floats()?, columns)),
            _ => None,
        })
        .ok_or_else(|| misfit("yolov8", format!("1×{rows}×n"), outputs))?;
    let anchors = (0..columns).map(|i| {
        let at = |row: usize| data[row * columns + i];
        Anchor {
            b: centred([at(0), at(1), at(2), at(3)]),
            output,
            objectness: None,
            first_label: 4 * columns + i,
            label: None,
            label_step: columns,
        }
    });
    Ok(Anchors::new(anchors.collect()))
}
