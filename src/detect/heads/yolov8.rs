//! YOLOv8, v9, 11, 12: one tensor 1×(4 + labels)×n, a column per box: centre and size in input pixels, then the labels'
//! scores; no objectness. Source: the Ultralytics documentation of its exports.

use super::super::nms::Candidate;
use super::{Tensor, best, from_centre, misfit};

pub(super) fn decode(outputs: &[Tensor], labels: usize) -> Result<Vec<Candidate>, String> {
    let rows = 4 + labels;
    let (data, columns) = outputs
        .iter()
        .find_map(|t| match t.shape[..] {
            [1, r, columns] if r == rows => Some((t.floats()?, columns)),
            _ => None,
        })
        .ok_or_else(|| misfit("yolov8", format!("1×{rows}×n"), outputs))?;
    let mut scores = vec![0.0; labels];
    let candidates = (0..columns).filter_map(|i| {
        let at = |row: usize| data[row * columns + i];
        scores.iter_mut().enumerate().for_each(|(label, s)| *s = at(4 + label));
        let (label, score) = best(&scores);
        from_centre(label, score, [at(0), at(1), at(2), at(3)])
    });
    Ok(candidates.collect())
}
