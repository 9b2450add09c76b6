//! YOLOv4 of the ONNX zoo: three tensors 1×rows×columns×3×(5 + labels) at strides 8, 16, 32; objectness and labels already
//! sigmoid.
//!
//! centre = (σ(output) · s − (s − 1)/2 + cell) · stride, size = exp(output) · anchor, score = objectness · label. Source:
//! Bochkovskiy et al. 2020 and the zoo's page on the model, which has the anchors and s.

use super::{Anchor, Anchors, HeadError, Tensor, centred, misfit, sigmoid};

/// One of the three grids.
struct Grid {
    stride: u32,
    /// By how much a centre may leave its cell.
    s: f32,
    /// Width, height in pixels.
    anchors: [[f32; 2]; 3],
}

const GRIDS: [Grid; 3] = [
    Grid {
        stride: 8,
        s: 1.2,
        anchors: [[12.0, 16.0], [19.0, 36.0], [40.0, 28.0]],
    },
    Grid {
        stride: 16,
        s: 1.1,
        anchors: [[36.0, 75.0], [76.0, 55.0], [72.0, 146.0]],
    },
    Grid {
        stride: 32,
        s: 1.05,
        anchors: [[142.0, 110.0], [192.0, 243.0], [459.0, 401.0]],
    },
];

pub(super) fn anchors(outputs: &[Tensor], [width, height]: [u32; 2], labels: usize) -> Result<Anchors, HeadError> {
    let row = 5 + labels;
    let mut found = Vec::new();
    for grid in &GRIDS {
        let (columns, rows) = ((width / grid.stride) as usize, (height / grid.stride) as usize);
        let tensor = Tensor::shaped(outputs, |shape| shape == [1, rows, columns, 3, row]);
        let (output, data) = tensor.ok_or_else(|| {
            let expected = format!("1×{rows}×{columns}×3×{row} for stride {}", grid.stride);
            misfit("yolov4", expected, outputs)
        })?;
        found.extend(data.chunks_exact(row).enumerate().map(|(i, o)| {
            let (cell, anchor) = (i / 3, grid.anchors[i % 3]);
            let (stride, s) = (grid.stride as f32, grid.s);
            let centre = |o: f32, cell: usize| (sigmoid(o) * s - (s - 1.0) / 2.0 + cell as f32) * stride;
            let centre_and_size = [
                centre(o[0], cell % columns),
                centre(o[1], cell / columns),
                o[2].exp() * anchor[0],
                o[3].exp() * anchor[1],
            ];
            Anchor::in_row(centred(centre_and_size), output, i * row + 5, true)
        }));
    }
    Ok(Anchors::new(found))
}
