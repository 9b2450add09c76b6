//! NanoDet: per stride n×labels sigmoid scores and n×(4·bins) box logits, picked by shape, with a batch axis or without.
//!
//! Each side's distance is the mean of a softmax over bins, times the stride; cells are centred at i·s + (s − 1)/2. Source:
//! Li et al. 2020 (generalised focal loss) and the NanoDet repository.

use super::{Anchor, Anchors, HeadError, Tensor, misfit};
use scaleproof_core::geometry::BoxPx;

pub(super) const BINS: usize = 8;

pub(super) fn anchors(
    outputs: &[Tensor],
    [width, height]: [u32; 2],
    strides: &[u32],
    labels: usize,
) -> Result<Anchors, HeadError> {
    if labels == 4 * BINS {
        // Scores and sides have the same shape then.
        return Err(misfit(
            "nanodet",
            format!("tables of other than {labels} columns for the labels"),
            outputs,
        ));
    }
    let mut found = Vec::new();
    for &stride in strides {
        let (columns, rows) = (width.div_ceil(stride), height.div_ceil(stride));
        let cells = (columns * rows) as usize;
        let is_table = |shape: &[usize], row: usize| matches!(shape, [1, n, r] | [n, r] if [*n, *r] == [cells, row]);
        let fits = |t: &Tensor, row: usize| is_table(&t.shape, row) && t.floats().is_some();
        let with = |row: usize| outputs.iter().position(|t| fits(t, row));
        let sides = with(4 * BINS).and_then(|i| outputs[i].floats());
        let (Some(output), Some(sides)) = (with(labels), sides) else {
            let expected = format!("1×{cells}×{labels} and 1×{cells}×{} for stride {stride}", 4 * BINS);
            return Err(misfit("nanodet", expected, outputs));
        };
        let cells = sides.chunks_exact(4 * BINS).enumerate();
        found.extend(cells.map(|(i, sides)| {
            let cell = [i as u32 % columns, i as u32 / columns];
            Anchor::in_row(box_of(cell, sides, stride), output, i * labels, false)
        }));
    }
    Ok(Anchors::new(found))
}

fn box_of(cell: [u32; 2], sides: &[f32], stride: u32) -> BoxPx {
    let s = f64::from(stride);
    let [cx, cy] = cell.map(|i| f64::from(i) * s + (s - 1.0) / 2.0);
    let side = |i: usize| expectation(&sides[i * BINS..][..BINS]) * s;
    BoxPx::new(cx - side(0), cy - side(1), cx + side(2), cy + side(3))
}

/// Mean bin under the softmax of some logits.
pub(super) fn expectation(logits: &[f32]) -> f64 {
    let highest = logits.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    let weights = logits.iter().map(|l| f64::from((l - highest).exp()));
    let (mut sum, mut weighted) = (0.0, 0.0);
    for (bin, weight) in weights.enumerate() {
        sum += weight;
        weighted += weight * bin as f64;
    }
    weighted / sum
}

#[cfg(test)]
mod tests {
    use super::super::Data;
    use super::*;
    use crate::nms::CandidateBox;

    fn decode(
        outputs: &[Tensor],
        size: [u32; 2],
        strides: &[u32],
        labels: usize,
    ) -> Result<Vec<CandidateBox>, HeadError> {
        Ok(anchors(outputs, size, strides, labels)?.candidates(outputs, labels))
    }

    /// Logits whose softmax mean is `distance`: all weight on the two bins around it.
    fn logits(distance: f64) -> [f32; BINS] {
        let low = distance.floor();
        let share = (distance - low).max(1e-9);
        let mut out = [-60.0; BINS];
        out[low as usize] = (1.0 - share).ln() as f32;
        out[low as usize + 1] = share.ln() as f32;
        out
    }

    #[test]
    fn an_encoded_box_comes_back() {
        let sizes = [(52 * 40, 8.0), (26 * 20, 16.0), (13 * 10, 32.0)];
        let mut outputs: Vec<Tensor> = Vec::new();
        for (cells, _) in sizes {
            outputs.push(Tensor::of_floats(&[1, cells, 80], vec![0.0; cells * 80]));
            outputs.push(Tensor::of_floats(&[1, cells, 32], vec![0.0; cells * 32]));
        }
        // Stride 16, cell (12, 6): centre (199.5, 103.5); box 150…260 × 80…120.
        let cell = 6 * 26 + 12;
        let ltrb = [49.5 / 16.0, 23.5 / 16.0, 60.5 / 16.0, 16.5 / 16.0]
            .map(logits)
            .concat();
        if let Data::F32(v) = &mut outputs[2].data {
            v[cell * 80 + 7] = 0.75;
        }
        if let Data::F32(v) = &mut outputs[3].data {
            v[cell * 32..][..32].copy_from_slice(&ltrb);
        }
        outputs.reverse(); // picked by shape, not by order
        let found = decode(&outputs, [416, 320], &[8, 16, 32], 80).unwrap();
        assert_eq!((found.len(), found[0].label, found[0].score), (1, 7, 0.75));
        let b = found[0].b;
        let expected = BoxPx::new(150.0, 80.0, 260.0, 120.0);
        assert!(b.iou(&expected) > 0.999, "{b:?}");
        assert!(
            decode(&outputs[1..], [416, 320], &[8, 16, 32], 80)
                .unwrap_err()
                .to_string()
                .contains("does not fit")
        );
    }
}
