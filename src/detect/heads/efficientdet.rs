//! EfficientDet before its postprocessing: offsets 1×n×4 (y, x, height, width) and scores or logits 1×n×labels, one row an anchor.
//!
//! Nine anchors a cell at strides 8 to 128: sides of 4 · stride · 2^(0, ⅓, ⅔), each as wide as high, 1.4 × 0.7 and 0.7 × 1.4; centre = anchor's centre
//! + offset · anchor's side, side = exp(offset) · anchor's side. Source: Tan et al. 2020, and `anchors.py` of google/automl's EfficientDet.

use super::{Anchor, Anchors, HeadError, Tensor, centred, misfit};
use crate::detect::manifest::Scores;

const STRIDES: [u32; 5] = [8, 16, 32, 64, 128];

/// Width and height in parts of an anchor's side.
const ASPECTS: [[f32; 2]; 3] = [[1.0, 1.0], [1.4, 0.7], [0.7, 1.4]];

/// How many anchors an input of width × height `size` in pixels has.
pub(crate) fn count(size: [u32; 2]) -> usize {
    let cells = STRIDES.map(|stride| size.map(|side| side.div_ceil(stride) as usize));
    9 * cells.map(|[columns, rows]| columns * rows).iter().sum::<usize>()
}

/// The 90 columns of COCO's category ids from 1 on are one fewer than the list of labels that begins with 0.
pub(super) fn anchors(outputs: &[Tensor], size: [u32; 2], scores: Scores, labels: usize) -> Result<Anchors, HeadError> {
    let rows = count(size);
    let refused = || {
        let expected = format!("1×{rows}×4 and 1×{rows}×{labels}");
        misfit("efficientdet", expected, outputs)
    };
    // Exports that add the anchors themselves call them so.
    let is_offsets = |t: &&Tensor| t.shape == [1, rows, 4] && !t.name.contains("anchor");
    let offsets = outputs
        .iter()
        .find(is_offsets)
        .and_then(Tensor::floats)
        .ok_or_else(refused)?;
    let fits = |t: &Tensor| matches!(t.shape[..], [1, n, columns] if n == rows && (columns == labels || columns + 1 == labels));
    let output = outputs
        .iter()
        .position(|t| fits(t) && t.floats().is_some())
        .ok_or_else(refused)?;
    let columns = outputs[output].shape[2];
    let boxes = own_boxes(size).zip(offsets.chunks_exact(4)).enumerate();
    let anchors = boxes.map(|(i, ([cx, cy, w, h], o))| {
        let b = centred([cx + o[1] * w, cy + o[0] * h, o[3].exp() * w, o[2].exp() * h]);
        Anchor::in_row(b, output, i * columns, false)
    });
    Ok(Anchors {
        are_logits: scores == Scores::Logits,
        first_scored: labels - columns,
        ..Anchors::new(anchors.collect())
    })
}

/// The anchors' centres and sizes in input pixels: by stride, row, column, size, aspect.
fn own_boxes([width, height]: [u32; 2]) -> impl Iterator<Item = [f32; 4]> {
    STRIDES.into_iter().flat_map(move |stride| {
        let (columns, rows) = (width.div_ceil(stride), height.div_ceil(stride));
        (0..columns * rows * 9).map(move |i| {
            let (cell, kind) = (i / 9, i % 9);
            let side = 4.0 * stride as f32 * 2_f32.powf((kind / 3) as f32 / 3.0);
            let [w, h] = ASPECTS[(kind % 3) as usize].map(|part| part * side);
            let centre = |cell: u32| (cell as f32 + 0.5) * stride as f32;
            [centre(cell % columns), centre(cell / columns), w, h]
        })
    })
}
