//! EfficientDet before its postprocessing: offsets 1×n×4 (y, x, height, width) and scores or logits 1×n×labels, one row an anchor.
//!
//! Nine anchors a cell at strides 8 to 128: sides of `anchor_scale` · stride · 2^(0, ⅓, ⅔), each as wide as high, 1.4 × 0.7 and 0.7 × 1.4; centre = anchor's centre
//! + offset · anchor's side, side = exp(offset) · anchor's side. Source: Tan et al. 2020, and `anchors.py` of google/automl's EfficientDet.

use super::{Anchor, Anchors, HeadError, Tensor, centred, misfit};
use crate::manifest::{EfficientdetHead, Scores};

const STRIDES: [u32; 5] = [8, 16, 32, 64, 128];

/// Width and height in parts of an anchor's side.
const ASPECTS: [[f32; 2]; 3] = [[1.0, 1.0], [1.4, 0.7], [0.7, 1.4]];

/// How many anchors an input of width × height `size` in pixels has.
pub fn count(size: [u32; 2]) -> usize {
    let cells = STRIDES.map(|stride| size.map(|side| side.div_ceil(stride) as usize));
    9 * cells.map(|[columns, rows]| columns * rows).iter().sum::<usize>()
}

/// Exports that add the anchors themselves call them so. COCO's 90 category ids from 1 on, and no other list, may be one fewer than the labels.
pub(super) fn anchors(
    outputs: &[Tensor],
    size: [u32; 2],
    head: EfficientdetHead,
    labels: usize,
) -> Result<Anchors, HeadError> {
    let rows = count(size);
    let find = || {
        let is_table = |t: &Tensor| !t.name.contains("anchor") && t.floats().is_some();
        let at = outputs.iter().position(|t| t.shape == [1, rows, 4] && is_table(t))?;
        let has_columns = |columns: usize| columns == labels || (columns, labels) == (90, 91);
        let fits = |t: &Tensor| matches!(t.shape[..], [1, n, columns] if n == rows && has_columns(columns));
        let mut others = outputs.iter().enumerate().filter(|(i, t)| *i != at && is_table(t));
        let (output, scores) = others.find(|(_, t)| fits(t))?;
        // With four labels both tables are alike: the offsets must then be named.
        let is_named = ["box", "reg"].iter().any(|name| outputs[at].name.contains(name));
        (labels != 4 || is_named).then_some((outputs[at].floats()?, output, scores.shape[2]))
    };
    let (offsets, output, columns) = find().ok_or_else(|| {
        let expected = format!("1×{rows}×4 and 1×{rows}×{labels}");
        misfit("efficientdet", expected, outputs)
    })?;
    let boxes = own_boxes(size, head.anchor_scale as f32)
        .zip(offsets.chunks_exact(4))
        .enumerate();
    let anchors = boxes.map(|(i, ([cx, cy, w, h], o))| {
        let b = centred([cx + o[1] * w, cy + o[0] * h, o[3].exp() * w, o[2].exp() * h]);
        Anchor::new(b, output, None, i * columns, 1)
    });
    Ok(Anchors {
        are_logits: head.scores == Scores::Logits,
        first_scored: labels - columns,
        ..Anchors::new(anchors.collect())
    })
}

/// The anchors' centres and sizes in input pixels: by stride, row, column, size, aspect. Where a last row or column is cut, all cells of its
/// grid are smaller.
fn own_boxes([width, height]: [u32; 2], anchor_scale: f32) -> impl Iterator<Item = [f32; 4]> {
    STRIDES.into_iter().flat_map(move |stride| {
        let (columns, rows) = (width.div_ceil(stride), height.div_ceil(stride));
        let step = [width as f32 / columns as f32, height as f32 / rows as f32];
        (0..columns * rows * 9).map(move |i| {
            let (cell, kind) = (i / 9, i % 9);
            let octave = anchor_scale * 2_f32.powf((kind / 3) as f32 / 3.0);
            let aspect = ASPECTS[(kind % 3) as usize];
            let [w, h] = [0, 1].map(|axis| aspect[axis] * octave * step[axis]);
            let centre = |cell: u32, axis: usize| (cell as f32 + 0.5) * step[axis];
            [centre(cell % columns, 0), centre(cell / columns, 1), w, h]
        })
    })
}
