//! Networks that choose their boxes by themselves and give them as numbers: RF-DETR's pairs, YOLOv10's rows.

use super::anchor::{Anchor, Anchors, best, centred, from_corners, scaled, sigmoid};
use super::error::{misfit, strange_label};
use super::tensor::Tensor;
use crate::SCORE_FLOOR;
use crate::nms::CandidateBox;
use scaleproof_core::message::Message;

/// RF-DETR, and RT-DETR and D-FINE as Transformers exports them: boxes 1×n×4 (centre and size as shares of the input) and logits
/// 1×n×labels, or one column more for "no object".
///
/// score = sigmoid(logit), and every pair of box and label is a candidate of its own, as the repository's `PostProcess` ranks
/// them; no suppression needed.
pub(super) fn rfdetr(outputs: &[Tensor], size: [u32; 2], labels: usize) -> Result<Vec<CandidateBox>, Message> {
    let (boxes, (_, logits), columns) = rfdetr_tables(outputs, labels)?;
    let [w, h] = size.map(|side| side as f32);
    let rows = boxes.chunks_exact(4).zip(logits.chunks_exact(columns));
    let pairs = rows.flat_map(|(b, logits)| {
        let b = centred([b[0] * w, b[1] * h, b[2] * w, b[3] * h]);
        let labelled = logits[..labels].iter().enumerate();
        labelled.filter_map(move |(label, logit)| from_corners(label, sigmoid(*logit), b))
    });
    Ok(pairs.collect())
}

/// DETR and YOLOS: boxes 1×n×4 (centre and size as shares of the input) and logits 1×n×(labels + 1), of which the last is for "no object".
///
/// score = softmax over all columns; a box is of its best label, "no object" left out, and nothing is suppressed. Source: Carion et al. 2020, and
/// `post_process_object_detection` of Transformers' `DetrImageProcessor`.
pub(super) fn detr(outputs: &[Tensor], size: [u32; 2], labels: usize) -> Result<Vec<CandidateBox>, Message> {
    let (boxes, (_, logits), columns) = tables(outputs, |columns| columns == labels + 1)
        .ok_or_else(|| misfit("detr", format!("boxes 1×n×4 and logits 1×n×{}", labels + 1), outputs))?;
    let rows = boxes.as_chunks::<4>().0.iter().zip(logits.chunks_exact(columns));
    let found = rows.filter_map(|(b, logits)| {
        let highest = logits.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        let sum: f32 = logits.iter().map(|logit| (logit - highest).exp()).sum();
        let (label, logit) = best(logits[..labels].iter().copied());
        from_corners(label, (logit - highest).exp() / sum, scaled(centred(*b), size))
    });
    Ok(found.collect())
}

/// RF-DETR's boxes with the logits of all labels each: the pairs of [`rfdetr`], for a gradient.
pub(super) fn rfdetr_anchors(outputs: &[Tensor], size: [u32; 2], labels: usize) -> Result<Anchors, Message> {
    let (boxes, (output, _), columns) = rfdetr_tables(outputs, labels)?;
    let of_box = |(i, b): (usize, &[f32])| {
        let b = scaled(centred([b[0], b[1], b[2], b[3]]), size);
        Anchor::new(b, output, None, i * columns, 1)
    };
    Ok(Anchors {
        are_logits: true,
        ..Anchors::new(boxes.chunks_exact(4).enumerate().map(of_box).collect())
    })
}

/// Boxes, logits with their output's number, and how many logits a box has.
type Tables<'a> = (&'a [f32], (usize, &'a [f32]), usize);

fn rfdetr_tables(outputs: &[Tensor], labels: usize) -> Result<Tables<'_>, Message> {
    // Transformers' networks with a column for "no object" take a softmax over all columns.
    let is_of_transformers = outputs.iter().any(|t| t.name == "pred_boxes");
    let fits = |columns: usize| columns == labels || (columns == labels + 1 && !is_of_transformers);
    tables(outputs, fits).ok_or_else(|| misfit("rfdetr", format!("boxes 1×n×4 and logits 1×n×{labels}"), outputs))
}

/// The two tables of a DETR. Where both have four columns the boxes are the output named so, or the first.
fn tables(outputs: &[Tensor], fits: impl Fn(usize) -> bool) -> Option<Tables<'_>> {
    let of_four = |t: &Tensor| matches!(t.shape[..], [1, _, 4]);
    let is_named = |t: &Tensor| t.name.contains("box") || t.name.contains("det");
    let named = outputs.iter().position(is_named).filter(|i| of_four(&outputs[*i]));
    let at = named.or_else(|| outputs.iter().position(of_four))?;
    let (logits, columns) = outputs.iter().enumerate().find_map(|(i, t)| match t.shape[..] {
        [1, n, columns] if i != at && n == outputs[at].shape[1] && fits(columns) => Some(((i, t.floats()?), columns)),
        _ => None,
    })?;
    Some((outputs[at].floats()?, logits, columns))
}

/// YOLOv10, YOLO26 and other YOLOs that need no suppression: one table 1×n×6: x1 y1 x2 y2 in input pixels, score, label. Source: Wang et
/// al. 2024 and the Ultralytics documentation of its exports.
pub(super) fn yolov10(outputs: &[Tensor], labels: usize) -> Result<Vec<CandidateBox>, Message> {
    let (_, rows) = yolov10_rows(outputs)?;
    // Rows of padding have any label, and no score.
    let rows = rows.iter().filter(|o| f64::from(o[4]) >= SCORE_FLOOR);
    let candidates = rows.map(|[x1, y1, x2, y2, score, label]| match named(*label, labels) {
        Some(label) => {
            let b = [*x1, *y1, *x2, *y2].map(f64::from);
            Ok(from_corners(label, *score, b.into()))
        }
        None => Err(strange_label(label.round(), labels)),
    });
    candidates.filter_map(Result::transpose).collect()
}

/// The rows of [`yolov10`] whose label is known, for a gradient.
pub(super) fn yolov10_anchors(outputs: &[Tensor], labels: usize) -> Result<Anchors, Message> {
    let (output, rows) = yolov10_rows(outputs)?;
    let of_row = |(i, [x1, y1, x2, y2, _, label]): (usize, &[f32; 6])| {
        let b = [*x1, *y1, *x2, *y2].map(f64::from);
        Some(Anchor {
            label: Some(named(*label, labels)?),
            ..Anchor::new(b.into(), output, None, 6 * i + 4, 1)
        })
    };
    Ok(Anchors::new(rows.iter().enumerate().filter_map(of_row).collect()))
}

fn yolov10_rows(outputs: &[Tensor]) -> Result<(usize, &[[f32; 6]]), Message> {
    let (output, data) = Tensor::shaped(outputs, |shape| matches!(shape, [1, _, 6]))
        .ok_or_else(|| misfit("yolov10", "1×n×6".into(), outputs))?;
    Ok((output, data.as_chunks().0))
}

/// A label that is written as a fraction, if it is one of so many.
fn named(label: f32, labels: usize) -> Option<usize> {
    let label = label.round();
    (0.0..labels as f32).contains(&label).then_some(label as usize)
}
