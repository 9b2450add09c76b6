//! YOLOv3 as Darknet computes it, not decoded: three tensors 1×(3·(5 + labels))×rows×columns at strides 8, 16, 32, all logits.
//!
//! centre = (σ(output) + cell) · stride, size = exp(output) · anchor, score = σ(objectness) · σ(label). Source: Redmon and Farhadi 2018, and
//! `yolov3.cfg` of the Darknet repository, which has the anchors.

use super::{Anchor, Anchors, HeadError, Tensor, centred, misfit, sigmoid};

/// Stride, and width and height of its three anchors in pixels.
const GRIDS: [(u32, [[f32; 2]; 3]); 3] = [
    (8, [[10.0, 13.0], [16.0, 30.0], [33.0, 23.0]]),
    (16, [[30.0, 61.0], [62.0, 45.0], [59.0, 119.0]]),
    (32, [[116.0, 90.0], [156.0, 198.0], [373.0, 326.0]]),
];

pub(super) fn anchors(outputs: &[Tensor], [width, height]: [u32; 2], labels: usize) -> Result<Anchors, HeadError> {
    let row = 5 + labels;
    let mut found = Vec::new();
    for (stride, sizes) in GRIDS {
        let (columns, rows) = ((width / stride) as usize, (height / stride) as usize);
        let plane = rows * columns;
        let tensor = Tensor::shaped(outputs, |shape| shape == [1, 3 * row, rows, columns]);
        let (output, data) = tensor.ok_or_else(|| {
            let expected = format!("1×{}×{rows}×{columns} for stride {stride}", 3 * row);
            misfit("yolov3", expected, outputs)
        })?;
        found.extend((0..3 * plane).map(|i| {
            let (size, cell) = (sizes[i / plane], i % plane);
            let first = i / plane * row * plane + cell;
            let at = |number: usize| data[first + number * plane];
            let centre = |number: usize, cell: usize| (sigmoid(at(number)) + cell as f32) * stride as f32;
            let centre_and_size = [
                centre(0, cell % columns),
                centre(1, cell / columns),
                at(2).exp() * size[0],
                at(3).exp() * size[1],
            ];
            Anchor {
                b: centred(centre_and_size),
                output,
                objectness: Some(first + 4 * plane),
                first_label: first + 5 * plane,
                label: None,
                label_step: plane,
            }
        }));
    }
    Ok(Anchors {
        are_logits: true,
        ..Anchors::new(found)
    })
}
