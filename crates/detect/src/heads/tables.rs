//! Heads that answer with one table, a row for each box, or a column for each.

use super::anchor::{Anchor, Anchors, centred};
use super::distances::{self, BINS};
use super::error::misfit;
use super::tensor::Tensor;
use crate::manifest::Unit;
use scaleproof_core::geometry::BoxPx;
use scaleproof_core::message::Message;

/// A table 1×n×`row`.
struct Table<'a> {
    output: usize,
    data: &'a [f32],
    row: usize,
}

impl Table<'_> {
    /// The first table with rows of such a length, and so many of them where their number is known.
    fn find<'a>(outputs: &'a [Tensor], kind: &str, rows: Option<usize>, row: usize) -> Result<Table<'a>, Message> {
        let fits = |shape: &[usize]| matches!(shape, [1, n, r] if *r == row && rows.is_none_or(|rows| rows == *n));
        let found = Tensor::shaped(outputs, fits).map(|(output, data)| Table { output, data, row });
        let rows = rows.map_or("n".to_owned(), |rows| rows.to_string());
        found.ok_or_else(|| misfit(kind, format!("1×{rows}×{row}"), outputs))
    }

    /// The boxes of all rows, whose scores lie from `first_label` on, behind the objectness if there is one.
    fn anchors(&self, first_label: usize, has_objectness: bool, box_of: impl Fn(usize, &[f32]) -> BoxPx) -> Anchors {
        let rows = self.data.chunks_exact(self.row).enumerate();
        let anchors = rows.map(|(i, row)| {
            let first = i * self.row + first_label;
            let objectness = has_objectness.then(|| first - 1);
            Anchor::new(box_of(i, row), self.output, objectness, first, 1)
        });
        Anchors::new(anchors.collect())
    }
}

/// Column, row and stride of every cell, stride by stride, row by row; `per_side` says how many cells of a stride a side has.
fn cells(size: [u32; 2], strides: &[u32], per_side: fn(u32, u32) -> u32) -> Vec<[u32; 3]> {
    let of_stride = |stride: &u32| {
        let ([columns, rows], stride) = (size.map(|side| per_side(side, *stride)), *stride);
        (0..columns * rows).map(move |i| [i % columns, i / columns, stride])
    };
    strides.iter().flat_map(of_stride).collect()
}

/// YOLOX: 1×cells×(4 + 1 + labels), strides 8, 16, 32.
///
/// centre = (output + cell) · stride, size = exp(output) · stride, score = objectness · label. Source: Ge et al. 2021 and
/// `demo_postprocess` of the YOLOX repository.
pub(super) fn yolox(outputs: &[Tensor], size: [u32; 2], labels: usize) -> Result<Anchors, Message> {
    let cells = cells(size, &[8, 16, 32], |side, stride| side / stride);
    let table = Table::find(outputs, "yolox", Some(cells.len()), 5 + labels)?;
    Ok(table.anchors(5, true, |i, o| {
        let [x, y, s] = cells[i].map(|v| v as f32);
        centred([(o[0] + x) * s, (o[1] + y) * s, o[2].exp() * s, o[3].exp() * s])
    }))
}

/// YOLOv5, v6, v7, and YOLOX exported with its decoding, and Darknet's once decoded: 1×n×(5 + labels), centre and size, score = objectness · label.
///
/// Older exports also give the three grids the table was made from. Source: the YOLOv5 repository's `non_max_suppression`.
pub(super) fn yolov5(outputs: &[Tensor], size: [u32; 2], labels: usize, unit: Unit) -> Result<Anchors, Message> {
    let table = Table::find(outputs, "yolov5", None, 5 + labels)?;
    let in_pixels = pixels(unit, size);
    Ok(table.anchors(5, true, |_, o| centred(in_pixels([o[0], o[1], o[2], o[3]]))))
}

fn pixels(unit: Unit, size: [u32; 2]) -> impl Fn([f32; 4]) -> [f32; 4] {
    let [w, h] = match unit {
        Unit::Pixels => [1.0; 2],
        Unit::Shares => size.map(|side| side as f32),
    };
    move |[cx, cy, width, height]| [cx * w, cy * h, width * w, height * h]
}

/// NanoDet-Plus: 1×cells×(labels + 4·bins), sigmoid scores, then box logits as NanoDet's; cells are centred at i·s. Source: the NanoDet
/// repository's `NanoDetPlusHead`.
pub(super) fn nanodet_plus(
    outputs: &[Tensor],
    size: [u32; 2],
    strides: &[u32],
    labels: usize,
) -> Result<Anchors, Message> {
    let cells = cells(size, strides, u32::div_ceil);
    let table = Table::find(outputs, "nanodet_plus", Some(cells.len()), labels + 4 * BINS)?;
    Ok(table.anchors(0, false, |i, o| {
        let [x, y, s] = cells[i].map(f64::from);
        distances::around([x * s, y * s], &o[labels..], s)
    }))
}

/// RT-DETR as Ultralytics exports it: 1×n×(4 + labels): centre and size as shares of the input, then the labels' scores; no suppression
/// needed. Source: Zhao et al. 2024 and the Ultralytics documentation.
pub(super) fn rtdetr(outputs: &[Tensor], size: [u32; 2], labels: usize) -> Result<Anchors, Message> {
    let in_pixels = pixels(Unit::Shares, size);
    let table = Table::find(outputs, "rtdetr", None, 4 + labels)?;
    Ok(table.anchors(4, false, |_, o| centred(in_pixels([o[0], o[1], o[2], o[3]]))))
}

/// YOLOv8, v9, 11, 12: 1×(4 + labels)×n, a column for each box: centre and size, then the labels' scores; no objectness. Source: the
/// Ultralytics documentation of its exports, whose TFLite ones give shares of the input instead of pixels. COCO's 90 category ids from 1 on, as SSDs
/// have them, may be one fewer than the labels.
pub(super) fn yolov8(outputs: &[Tensor], size: [u32; 2], labels: usize, unit: Unit) -> Result<Anchors, Message> {
    let fits = |rows: usize| rows == 4 + labels || (rows, labels) == (94, 91);
    let (output, data) = Tensor::shaped(outputs, |shape| matches!(shape, [1, rows, _] if fits(*rows)))
        .ok_or_else(|| misfit("yolov8", format!("1×{}×n", 4 + labels), outputs))?;
    let rows = outputs[output].shape[1];
    let (columns, in_pixels) = (data.len() / rows, pixels(unit, size));
    let anchors = (0..columns).map(|i| {
        let b = centred(in_pixels([0, 1, 2, 3].map(|row| data[row * columns + i])));
        Anchor::new(b, output, None, 4 * columns + i, columns)
    });
    Ok(Anchors {
        first_scored: 4 + labels - rows,
        ..Anchors::new(anchors.collect())
    })
}
