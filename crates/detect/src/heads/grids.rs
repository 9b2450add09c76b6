//! Heads that answer with grids of cells, not decoded.

use super::{Anchor, Anchors, HeadError, Tensor, centred, misfit, sigmoid};

/// One of the three grids of YOLOv3 or YOLOv4: its stride, by how much a centre may leave its cell (1: not at all), and width and height of
/// its three anchors in pixels.
type Grid = (u32, f32, [[f32; 2]; 3]);

/// Source: `yolov3.cfg` of the Darknet repository.
const YOLOV3: [Grid; 3] = [
    (8, 1.0, [[10.0, 13.0], [16.0, 30.0], [33.0, 23.0]]),
    (16, 1.0, [[30.0, 61.0], [62.0, 45.0], [59.0, 119.0]]),
    (32, 1.0, [[116.0, 90.0], [156.0, 198.0], [373.0, 326.0]]),
];

/// Source: the ONNX zoo's page on the model.
const YOLOV4: [Grid; 3] = [
    (8, 1.2, [[12.0, 16.0], [19.0, 36.0], [40.0, 28.0]]),
    (16, 1.1, [[36.0, 75.0], [76.0, 55.0], [72.0, 146.0]]),
    (32, 1.05, [[142.0, 110.0], [192.0, 243.0], [459.0, 401.0]]),
];

/// YOLOv3 as Darknet computes it: three tensors 1×(3·(5 + labels))×rows×columns at strides 8, 16, 32, all logits; score = σ(objectness) ·
/// σ(label). Source: Redmon and Farhadi 2018.
pub(super) fn yolov3(outputs: &[Tensor], size: [u32; 2], labels: usize) -> Result<Anchors, HeadError> {
    Ok(Anchors {
        are_logits: true,
        ..Anchors::new(decoded(outputs, size, labels, "yolov3", &YOLOV3)?)
    })
}

/// YOLOv4 of the ONNX zoo: three tensors 1×rows×columns×3×(5 + labels) at strides 8, 16, 32; objectness and labels already sigmoid; score =
/// objectness · label. Source: Bochkovskiy et al. 2020.
pub(super) fn yolov4(outputs: &[Tensor], size: [u32; 2], labels: usize) -> Result<Anchors, HeadError> {
    Ok(Anchors::new(decoded(outputs, size, labels, "yolov4", &YOLOV4)?))
}

/// centre = (σ(output) · s − (s − 1)/2 + cell) · stride, size = exp(output) · anchor.
fn decoded(
    outputs: &[Tensor],
    size: [u32; 2],
    labels: usize,
    kind: &'static str,
    grids: &[Grid; 3],
) -> Result<Vec<Anchor>, HeadError> {
    let (row, is_planar) = (5 + labels, kind == "yolov3");
    let mut found = Vec::new();
    for (stride, s, anchors) in grids {
        let [columns, rows] = size.map(|side| (side / stride) as usize);
        let plane = rows * columns;
        let shape = if is_planar {
            vec![1, 3 * row, rows, columns]
        } else {
            vec![1, rows, columns, 3, row]
        };
        let (output, data) = Tensor::shaped(outputs, |found| found == shape).ok_or_else(|| {
            let shape: Vec<String> = shape.iter().map(usize::to_string).collect();
            misfit(kind, format!("{} for stride {stride}", shape.join("×")), outputs)
        })?;
        found.extend((0..3 * plane).map(|i| {
            // Which of the three anchors, where its numbers begin, and how far apart they are.
            let (nth, cell, first, step) = if is_planar {
                (i / plane, i % plane, i / plane * row * plane + i % plane, plane)
            } else {
                (i % 3, i / 3, i * row, 1)
            };
            let at = |number: usize| data[first + number * step];
            let centre =
                |number: usize, cell: usize| (sigmoid(at(number)) * s - (s - 1.0) / 2.0 + cell as f32) * *stride as f32;
            let [w, h] = [0, 1].map(|axis| at(2 + axis).exp() * anchors[nth][axis]);
            let b = centred([centre(0, cell % columns), centre(1, cell / columns), w, h]);
            Anchor::new(b, output, Some(first + 4 * step), first + 5 * step, step)
        }));
    }
    Ok(found)
}

/// FastestDet: one tensor 1×(1 + 4 + labels)×rows×columns.
///
/// score = objectness^0.6 · label^0.4 (so not comparable with other detectors' scores); centre = cell + tanh(offset), size =
/// sigmoid, both as a share of the input. Source: the FastestDet repository's `handle_preds`.
pub(super) fn fastestdet(outputs: &[Tensor], size: [u32; 2], labels: usize) -> Result<Anchors, HeadError> {
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
