//! NanoDet: each side's distance is the mean of a softmax over bins, times the stride. Source: Li et al. 2020 (generalised focal loss) and
//! the NanoDet repository.

use super::anchor::{Anchor, Anchors};
use super::error::misfit;
use super::tensor::Tensor;
use scaleproof_core::geometry::BoxPx;
use scaleproof_core::message::Message;

/// Logits for each side of a box.
pub(crate) const BINS: usize = 8;

/// Centres of NanoDet's cells, at i·s + (s − 1)/2, in input pixels from their middle.
pub(super) const NANODET: f64 = -0.5;
/// Centres of PicoDet's cells, in their middle. Source: `PicoHead` of PaddleDetection, whose `cell_offset` is 0.5 (Yu et al. 2021).
pub(super) const PICODET: f64 = 0.0;

/// NanoDet and PicoDet: per stride n×labels sigmoid scores and n×(4·bins) box logits, picked by shape, with a batch axis or without; cells are
/// centred at (i + ½)·s + `shift`, in input pixels.
pub(super) fn by_stride(
    kind: &str,
    outputs: &[Tensor],
    size: [u32; 2],
    strides: &[u32],
    labels: usize,
    shift: f64,
) -> Result<Anchors, Message> {
    if labels == 4 * BINS {
        // Scores and sides have the same shape then.
        let expected = format!("tables of other than {labels} columns for the labels");
        return Err(misfit(kind, expected, outputs));
    }
    let mut found = Vec::new();
    for &stride in strides {
        let [columns, rows] = size.map(|side| side.div_ceil(stride));
        let cells = (columns * rows) as usize;
        let with =
            |row: usize| Tensor::shaped(outputs, |s| matches!(s, [1, n, r] | [n, r] if [*n, *r] == [cells, row]));
        let (Some((output, _)), Some((_, sides))) = (with(labels), with(4 * BINS)) else {
            let expected = format!("1×{cells}×{labels} and 1×{cells}×{} for stride {stride}", 4 * BINS);
            return Err(misfit(kind, expected, outputs));
        };
        let cells = sides.chunks_exact(4 * BINS).enumerate();
        found.extend(cells.map(|(i, sides)| {
            let s = f64::from(stride);
            let centre = [i as u32 % columns, i as u32 / columns].map(|i| f64::from(i) * s + s / 2.0 + shift);
            Anchor::new(around(centre, sides, s), output, None, i * labels, 1)
        }));
    }
    Ok(Anchors::new(found))
}

/// The box around a centre whose four distances some logits give, in strides of `s` pixels.
pub(super) fn around([cx, cy]: [f64; 2], logits: &[f32], s: f64) -> BoxPx {
    let side = |i: usize| expectation(&logits[i * BINS..][..BINS]) * s;
    BoxPx::new(cx - side(0), cy - side(1), cx + side(2), cy + side(3))
}

/// Mean bin under the softmax of some logits.
fn expectation(logits: &[f32]) -> f64 {
    let highest = logits.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    let weights = logits.iter().map(|l| f64::from((l - highest).exp()));
    let (mut sum, mut weighted) = (0.0, 0.0);
    for (bin, weight) in weights.enumerate() {
        sum += weight;
        weighted += weight * bin as f64;
    }
    weighted / sum
}
