//! FastestDet: one tensor 1×(1 + 4 + labels)×rows×columns.
//!
//! score = objectness^0.6 · label^0.4 (so not comparable with other detectors' scores); centre = cell + tanh(offset), size =
//! sigmoid, both as a share of the input. Source: the FastestDet repository's `handle_preds`.

use super::{Anchor, Anchors, HeadError, Tensor, centred, misfit, sigmoid};

pub(super) fn anchors(outputs: &[Tensor], [width, height]: [u32; 2], labels: usize) -> Result<Anchors, HeadError> {
    let (columns, rows) = ((width / 16) as usize, (height / 16) as usize);
    let data = outputs
        .first()
        .filter(|t| t.shape == [1, 5 + labels, rows, columns])
        .and_then(Tensor::floats)
        .ok_or_else(|| misfit("fastestdet", format!("1×{}×{rows}×{columns}", 5 + labels), outputs))?;
    let plane = columns * rows;
    let cells = (0..plane).map(|cell| {
        let at = |channel: usize| data[channel * plane + cell];
        let (x, y) = ((cell % columns) as f32, (cell / columns) as f32);
        let (w, h) = (width as f32, height as f32);
        let centre_and_size = [
            (x + at(1).tanh()) / columns as f32 * w,
            (y + at(2).tanh()) / rows as f32 * h,
            sigmoid(at(3)) * w,
            sigmoid(at(4)) * h,
        ];
        Anchor {
            b: centred(centre_and_size),
            output: 0,
            objectness: Some(cell),
            first_label: 5 * plane + cell,
            label: None,
            label_step: plane,
        }
    });
    Ok(Anchors {
        exponents: [0.6, 0.4],
        ..Anchors::new(cells.collect())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nms::CandidateBox;

    fn decode(outputs: &[Tensor], size: [u32; 2], labels: usize) -> Result<Vec<CandidateBox>, HeadError> {
        Ok(anchors(outputs, size, labels)?.candidates(outputs, labels))
    }

    #[test]
    fn an_encoded_box_comes_back() {
        let (columns, rows, plane) = (22, 20, 440);
        let mut data = vec![0.0_f32; 85 * plane];
        // Cell (10, 5) of a 352×320 input; centre (10.3, 5.6) cells, size 0.25 × 0.1 of the input.
        let cell = 5 * columns + 10;
        for (channel, value) in [
            (0, 0.8),
            (1, 0.3_f32.atanh()),
            (2, 0.6_f32.atanh()),
            (3, (0.25_f32 / 0.75).ln()),
            (4, (0.1_f32 / 0.9).ln()),
            (5 + 2, 0.5),
        ] {
            data[channel * plane + cell] = value;
        }
        let tensor = Tensor::of_floats(&[1, 85, rows, columns], data);
        let found = decode(&[tensor], [352, 320], 80).unwrap();
        assert_eq!((found.len(), found[0].label), (1, 2));
        assert!((found[0].score - 0.8_f64.powf(0.6) * 0.5_f64.powf(0.4)).abs() < 1e-6);
        let b = found[0].b;
        assert!(
            (b.x1 - (164.8 - 44.0)).abs() < 1e-3 && (b.y2 - (89.6 + 16.0)).abs() < 1e-3,
            "{b:?}"
        );
    }
}
