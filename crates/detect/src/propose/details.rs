//! Details of a head that follow from a network's numbers: whether boxes are pixels or shares, and in which order their sides come.

use crate::heads::{Data, Pair, Tensor, ssd};
use crate::manifest::{SsdBoxes, Unit};

/// Shares of an image's side; boxes may reach beyond it.
pub(super) const SHARES: std::ops::RangeInclusive<f32> = -1.5..=2.5;

/// Returns whether some centres and sizes are pixels or shares.
pub(super) fn unit(mut values: impl Iterator<Item = f32>) -> Unit {
    if values.all(|v| SHARES.contains(&v)) {
        Unit::Shares
    } else {
        Unit::Pixels
    }
}

/// Returns what the boxes beside some scores are; `None` where they are neither decoded nor offsets from prior boxes that are known.
pub(super) fn ssd_boxes(outputs: &[Tensor], pair: Pair, size: [u32; 2]) -> Option<SsdBoxes> {
    let boxes = outputs[pair.boxes].floats()?.as_chunks::<4>().0;
    let is_decoded = |[a, b, c, d]: &[f32; 4]| c >= a && d >= b;
    if boxes.iter().all(is_decoded) {
        if !boxes.iter().flatten().all(|v| SHARES.contains(v)) {
            return Some(SsdBoxes::XyxyPixels);
        }
        // Row by row through a grid, x changes with every cell and y with every row.
        let moves = |axis: usize| boxes.windows(2).map(|b| (b[1][axis] - b[0][axis]).abs()).sum::<f32>();
        let is_x_first = moves(0) + moves(2) >= moves(1) + moves(3);
        return Some(if is_x_first { SsdBoxes::Xyxy } else { SsdBoxes::Yxyx });
    }
    ssd::priors(outputs, size, pair.rows).map(|_| SsdBoxes::Offsets)
}

/// Its values, where they are fractions.
pub(super) fn floats(t: &Tensor) -> impl Iterator<Item = f32> {
    t.floats().unwrap_or_default().iter().copied()
}

pub(super) fn table(outputs: &[Tensor], row: usize) -> Option<&Tensor> {
    let is_table = |t: &&Tensor| t.shape.len() == 3 && t.shape.last() == Some(&row);
    outputs.iter().find(is_table)
}

pub(super) fn columns(t: &Tensor, of: impl std::ops::RangeBounds<usize>) -> impl Iterator<Item = f32> {
    let row = t.shape.last().copied().unwrap_or(1).max(1);
    let all = floats(t).enumerate();
    all.filter(move |(i, _)| of.contains(&(i % row))).map(|(_, v)| v)
}

/// The boxes among outputs that list labels, boxes and scores.
pub(super) fn listed_boxes(outputs: &[Tensor]) -> Option<&Tensor> {
    let whole = outputs.iter().find(|t| matches!(t.data, Data::I64(_)))?;
    let count: usize = whole.shape.iter().product();
    let is_boxes = |t: &&Tensor| t.shape.last() == Some(&4) && t.shape.iter().product::<usize>() == 4 * count;
    outputs.iter().find(is_boxes)
}
