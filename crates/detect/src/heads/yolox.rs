//! YOLOX: one tensor 1×cells×(4 + 1 + labels), strides 8, 16, 32, row-major cells.
//!
//! centre = (output + cell) · stride, size = exp(output) · stride, score = objectness · label. Source: Ge et al. 2021 and
//! `demo_postprocess` of the YOLOX repository.

use super::{Anchor, Anchors, HeadError, Tensor, centred, misfit};

const STRIDES: [u32; 3] = [8, 16, 32];

pub(super) fn anchors(outputs: &[Tensor], [width, height]: [u32; 2], labels: usize) -> Result<Anchors, HeadError> {
    let cells: usize = STRIDES.iter().map(|s| ((width / s) * (height / s)) as usize).sum();
    let row = 5 + labels;
    let data = outputs
        .first()
        .filter(|t| t.shape == [1, cells, row])
        .and_then(Tensor::floats)
        .ok_or_else(|| misfit("yolox", format!("1×{cells}×{row}"), outputs))?;
    let grid = STRIDES.iter().flat_map(|s| {
        let columns = width / s;
        (0..columns * (height / s)).map(move |i| (i % columns, i / columns, *s))
    });
    let rows = grid.zip(data.chunks_exact(row)).enumerate();
    let anchors = rows.map(|(i, ((x, y, stride), o))| {
        let s = stride as f32;
        let centre_and_size = [
            (o[0] + x as f32) * s,
            (o[1] + y as f32) * s,
            o[2].exp() * s,
            o[3].exp() * s,
        ];
        Anchor::in_row(centred(centre_and_size), 0, i * row + 5, true)
    });
    Ok(Anchors::new(anchors.collect()))
}

#[cfg(test)]
mod tests {
    use super::super::Data;
    use super::*;
    use crate::nms::CandidateBox;

    fn decode(outputs: &[Tensor], size: [u32; 2], labels: usize) -> Result<Vec<CandidateBox>, HeadError> {
        Ok(anchors(outputs, size, labels)?.candidates(outputs, labels))
    }

    /// Encodes a box as the network would answer it, at the cell its centre falls into.
    fn encoded(cx: f32, cy: f32, w: f32, h: f32, stride_index: usize) -> Tensor {
        let cells = 52 * 40 + 26 * 20 + 13 * 10;
        let first: usize = [0, 52 * 40, 52 * 40 + 26 * 20][stride_index];
        let s = [8.0, 16.0, 32.0][stride_index];
        let (x, y) = ((cx / s).floor(), (cy / s).floor());
        let mut data = vec![0.0; cells * 85];
        let row = &mut data[(first + y as usize * (416 / s as usize) + x as usize) * 85..][..85];
        row[..5].copy_from_slice(&[cx / s - x, cy / s - y, (w / s).ln(), (h / s).ln(), 0.9]);
        row[5 + 2] = 0.5;
        Tensor::of_floats(&[1, cells, 85], data)
    }

    #[test]
    fn an_encoded_box_comes_back_from_every_stride() {
        for stride_index in 0..3 {
            let found = decode(&[encoded(203.0, 101.5, 90.0, 33.0, stride_index)], [416, 320], 80).unwrap();
            assert_eq!(found.len(), 1);
            let (c, b) = (&found[0], found[0].b);
            assert!((c.score - 0.45).abs() < 1e-6 && c.label == 2);
            assert!((b.x1 - 158.0).abs() < 1e-3 && (b.y2 - 118.0).abs() < 1e-3, "{b:?}");
        }
    }

    #[test]
    fn nan_outputs_and_other_shapes_give_no_box() {
        let mut t = encoded(200.0, 100.0, 50.0, 50.0, 0);
        if let Data::F32(v) = &mut t.data {
            v.iter_mut().for_each(|v| *v = f32::NAN);
        }
        assert!(decode(std::slice::from_ref(&t), [416, 320], 80).unwrap().is_empty());
        t.shape = vec![1, 3549, 85];
        assert!(
            decode(&[t], [416, 320], 80)
                .unwrap_err()
                .to_string()
                .contains("does not fit")
        );
    }
}
