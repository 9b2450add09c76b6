//! Heads that answer with grids of cells, not decoded.

use std::sync::LazyLock;

use super::anchor::{Anchor, Anchors, centred, sigmoid};
use super::error::misfit;
use super::tensor::Tensor;
use crate::manifest::GridAnchors;
use scaleproof_core::message::Message;

fn grid(stride: u32, scale_xy: f32, anchors: &[[f32; 2]]) -> GridAnchors {
    let anchors = anchors.to_vec();
    GridAnchors {
        stride,
        scale_xy,
        anchors,
    }
}

/// Source: `yolov3.cfg` of the Darknet repository.
static YOLOV3: LazyLock<[GridAnchors; 3]> = LazyLock::new(|| {
    [
        grid(8, 1.0, &[[10.0, 13.0], [16.0, 30.0], [33.0, 23.0]]),
        grid(16, 1.0, &[[30.0, 61.0], [62.0, 45.0], [59.0, 119.0]]),
        grid(32, 1.0, &[[116.0, 90.0], [156.0, 198.0], [373.0, 326.0]]),
    ]
});

/// Source: the ONNX zoo's page on the model.
static YOLOV4: LazyLock<[GridAnchors; 3]> = LazyLock::new(|| {
    [
        grid(8, 1.2, &[[12.0, 16.0], [19.0, 36.0], [40.0, 28.0]]),
        grid(16, 1.1, &[[36.0, 75.0], [76.0, 55.0], [72.0, 146.0]]),
        grid(32, 1.05, &[[142.0, 110.0], [192.0, 243.0], [459.0, 401.0]]),
    ]
});

/// YOLOv3: grids as Darknet computes them, all logits; score = σ(objectness) · σ(label). Its three where none are named. Source: Redmon and
/// Farhadi 2018.
pub(super) fn yolov3(
    outputs: &[Tensor],
    size: [u32; 2],
    labels: usize,
    grids: &[GridAnchors],
) -> Result<Anchors, Message> {
    let grids = if grids.is_empty() { &*YOLOV3 } else { grids };
    Ok(Anchors {
        are_logits: true,
        ..decoded(outputs, size, labels, "yolov3", grids)?
    })
}

/// YOLOv4 of the ONNX zoo: grids with objectness and labels already sigmoid; score = objectness · label. Its three where none are named. Source:
/// Bochkovskiy et al. 2020.
pub(super) fn yolov4(
    outputs: &[Tensor],
    size: [u32; 2],
    labels: usize,
    grids: &[GridAnchors],
) -> Result<Anchors, Message> {
    let grids = if grids.is_empty() { &*YOLOV4 } else { grids };
    decoded(outputs, size, labels, "yolov4", grids)
}

/// The order of a grid's numbers: for n anchors and r numbers a box, 1×(n·r)×rows×columns as Darknet has them, 1×n×rows×columns×r,
/// 1×rows×columns×n×r, or 1×rows×columns×(n·r).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Order {
    Planes,
    AnchorsFirst,
    AnchorsLast,
}

impl Order {
    fn of_shape(shape: &[usize], [columns, rows]: [usize; 2], anchors: usize, row: usize) -> Option<Order> {
        let (all, s) = (anchors * row, shape);
        match s.len() {
            4 if s == [1, all, rows, columns] => Some(Order::Planes),
            4 if s == [1, rows, columns, all] => Some(Order::AnchorsLast),
            5 if s == [1, anchors, rows, columns, row] => Some(Order::AnchorsFirst),
            5 if s == [1, rows, columns, anchors, row] => Some(Order::AnchorsLast),
            _ => None,
        }
    }

    /// Returns where the numbers of the nth anchor of a cell begin, and how far apart they are.
    fn place(self, nth: usize, cell: usize, plane: usize, anchors: usize, row: usize) -> (usize, usize) {
        match self {
            Order::Planes => (nth * row * plane + cell, plane),
            Order::AnchorsFirst => ((nth * plane + cell) * row, 1),
            Order::AnchorsLast => ((cell * anchors + nth) * row, 1),
        }
    }
}

/// centre = (σ(output) · s − (s − 1)/2 + cell) · stride, size = exp(output) · anchor.
fn decoded(
    outputs: &[Tensor],
    size: [u32; 2],
    labels: usize,
    kind: &str,
    grids: &[GridAnchors],
) -> Result<Anchors, Message> {
    let row = 5 + labels;
    let mut found = Vec::new();
    for GridAnchors {
        stride,
        scale_xy: s,
        anchors,
    } in grids
    {
        let sides @ [columns, rows] = size.map(|side| (side / stride) as usize);
        let (plane, count) = (rows * columns, anchors.len());
        let order_of = |shape: &[usize]| Order::of_shape(shape, sides, count, row);
        let (output, data) = Tensor::shaped(outputs, |shape| order_of(shape).is_some()).ok_or_else(|| {
            let expected = format!("1×{}×{rows}×{columns} for stride {stride}", count * row);
            misfit(kind, expected, outputs)
        })?;
        let order = order_of(&outputs[output].shape).unwrap_or(Order::Planes);
        found.extend((0..count * plane).map(|i| {
            let (nth, cell) = (i / plane, i % plane);
            let (first, step) = order.place(nth, cell, plane, count, row);
            let at = |number: usize| data[first + number * step];
            let centre =
                |number: usize, cell: usize| (sigmoid(at(number)) * s - (s - 1.0) / 2.0 + cell as f32) * *stride as f32;
            let [w, h] = [0, 1].map(|axis| at(2 + axis).exp() * anchors[nth][axis]);
            let b = centred([centre(0, cell % columns), centre(1, cell / columns), w, h]);
            Anchor::new(b, output, Some(first + 4 * step), first + 5 * step, step)
        }));
    }
    Ok(Anchors::new(found))
}

/// FastestDet: one tensor 1×(1 + 4 + labels)×rows×columns.
///
/// score = objectness^0.6 · label^0.4 (so not comparable with other detectors' scores); centre = cell + tanh(offset), size =
/// sigmoid, both as a share of the input. Source: the FastestDet repository's `handle_preds`.
pub(super) fn fastestdet(outputs: &[Tensor], size: [u32; 2], labels: usize) -> Result<Anchors, Message> {
    let [columns, rows] = size.map(|side| (side / 16) as usize);
    let (output, data) = Tensor::shaped(outputs, |shape| shape == [1, 5 + labels, rows, columns])
        .ok_or_else(|| misfit("fastestdet", format!("1×{}×{rows}×{columns}", 5 + labels), outputs))?;
    let plane = columns * rows;
    let cells = (0..plane).map(|cell| {
        let at = |channel: usize| data[channel * plane + cell];
        let [w, h] = size.map(|side| side as f32);
        let cx = ((cell % columns) as f32 + at(1).tanh()) / columns as f32 * w;
        let cy = ((cell / columns) as f32 + at(2).tanh()) / rows as f32 * h;
        let b = centred([cx, cy, sigmoid(at(3)) * w, sigmoid(at(4)) * h]);
        Anchor::new(b, output, Some(cell), 5 * plane + cell, plane)
    });
    Ok(Anchors {
        exponents: [0.6, 0.4],
        ..Anchors::new(cells.collect())
    })
}
