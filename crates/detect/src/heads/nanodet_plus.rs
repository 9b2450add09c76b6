//! NanoDet-Plus: one tensor 1×cells×(labels + 4·bins), sigmoid scores, then box logits as NanoDet's; cells of all strides in
//! order, centred at i·s. Source: the NanoDet repository's `NanoDetPlusHead`.

use super::nanodet::{BINS, expectation};
use super::{Anchor, Anchors, HeadError, Tensor, misfit};
use scaleproof_core::geometry::BoxPx;

pub(super) fn anchors(
    outputs: &[Tensor],
    [width, height]: [u32; 2],
    strides: &[u32],
    labels: usize,
) -> Result<Anchors, HeadError> {
    let cells: Vec<[u32; 3]> = strides
        .iter()
        .flat_map(|s| {
            let (columns, rows) = (width.div_ceil(*s), height.div_ceil(*s));
            (0..columns * rows).map(move |i| [i % columns, i / columns, *s])
        })
        .collect();
    let row = labels + 4 * BINS;
    let (output, data) = Tensor::shaped(outputs, |shape| shape == [1, cells.len(), row])
        .ok_or_else(|| misfit("nanodet_plus", format!("1×{}×{row}", cells.len()), outputs))?;
    let rows = cells.iter().zip(data.chunks_exact(row)).enumerate();
    let anchors = rows.map(|(i, (cell, o))| {
        let [x, y, s] = cell.map(f64::from);
        let side = |i: usize| expectation(&o[labels + i * BINS..][..BINS]) * s;
        let b = BoxPx::new(x * s - side(0), y * s - side(1), x * s + side(2), y * s + side(3));
        Anchor::in_row(b, output, i * row, false)
    });
    Ok(Anchors::new(anchors.collect()))
}
