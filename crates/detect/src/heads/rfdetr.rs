//! RF-DETR, and RT-DETR and D-FINE as Transformers exports them: boxes 1×n×4 (centre and size as shares of the input) and logits 1×n×labels, or one column more for "no object".
//!
//! score = sigmoid(logit), and every pair of box and label is a candidate of its own, as the repository's `PostProcess` ranks
//! them; no suppression needed.

use super::super::nms::CandidateBox;
use super::{Anchor, Anchors, HeadError, Tensor, centred, from_centre, misfit, scaled, sigmoid};

pub(super) fn decode(
    outputs: &[Tensor],
    [width, height]: [u32; 2],
    labels: usize,
) -> Result<Vec<CandidateBox>, HeadError> {
    let (boxes, logits, columns) = checked(outputs, labels)?;
    let (w, h) = (width as f32, height as f32);
    let rows = boxes.chunks_exact(4).zip(logits.chunks_exact(columns));
    let pairs = rows.flat_map(|(b, logits)| {
        let centre_and_size = [b[0] * w, b[1] * h, b[2] * w, b[3] * h];
        let labelled = logits[..labels].iter().enumerate();
        labelled.filter_map(move |(label, logit)| from_centre(label, sigmoid(*logit), centre_and_size))
    });
    Ok(pairs.collect())
}

/// Its boxes with the logits of all labels each: the pairs of [`decode`], for a gradient.
pub(super) fn anchors(outputs: &[Tensor], size: [u32; 2], labels: usize) -> Result<Anchors, HeadError> {
    let (boxes, logits, columns) = checked(outputs, labels)?;
    let output = outputs
        .iter()
        .position(|t| t.floats().is_some_and(|v| std::ptr::eq(v, logits)));
    let of_box = |(i, b): (usize, &[f32])| {
        let b = scaled(centred([b[0], b[1], b[2], b[3]]), size);
        Anchor::in_row(b, output.unwrap_or(0), i * columns, false)
    };
    Ok(Anchors {
        are_logits: true,
        ..Anchors::new(boxes.chunks_exact(4).enumerate().map(of_box).collect())
    })
}

type Tables<'a> = (&'a [f32], &'a [f32], usize);

fn checked(outputs: &[Tensor], labels: usize) -> Result<Tables<'_>, HeadError> {
    tensors(outputs, labels).ok_or_else(|| misfit("rfdetr", format!("boxes 1×n×4 and logits 1×n×{labels}"), outputs))
}

/// Boxes, logits, and how many logits a box has. With three or four labels both have four columns: then the boxes are the output named so,
/// or the first.
fn tensors(outputs: &[Tensor], labels: usize) -> Option<Tables<'_>> {
    let named = outputs
        .iter()
        .position(|t| t.name.contains("box") || t.name.contains("det"));
    let of_four = |t: &Tensor| matches!(t.shape[..], [1, _, 4]);
    let at = named
        .filter(|i| of_four(&outputs[*i]))
        .or_else(|| outputs.iter().position(of_four))?;
    let count = outputs[at].shape[1];
    // Transformers' networks with a column for "no object" take a softmax over all columns.
    let is_of_transformers = outputs.iter().any(|t| t.name == "pred_boxes");
    let fits = |columns: usize| columns == labels || (columns == labels + 1 && !is_of_transformers);
    let logits = outputs.iter().enumerate().find_map(|(i, t)| match t.shape[..] {
        [1, n, columns] if i != at && n == count && fits(columns) => Some((t.floats()?, columns)),
        _ => None,
    });
    logits.and_then(|(logits, columns)| Some((outputs[at].floats()?, logits, columns)))
}
