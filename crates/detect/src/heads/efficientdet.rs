//! EfficientDet before its postprocessing: offsets 1×n×4 (y, x, height, width) and scores or logits 1×n×labels, one row an anchor; or, as effdet's network gives
//! them before it joins them, a pair of grids for each stride, 1×(9·labels)×rows×columns and 1×36×rows×columns.
//!
//! Nine anchors a cell at strides 8 to 128: sides of `anchor_scale` · stride · 2^(0, ⅓, ⅔), each as wide as high, 1.4 × 0.7 and 0.7 × 1.4; centre = anchor's centre
//! + offset · anchor's side, side = exp(offset) · anchor's side. Source: Tan et al. 2020, and `anchors.py` of google/automl's EfficientDet.

use super::anchor::{Anchor, Anchors, centred};
use super::error::misfit;
use super::tensor::Tensor;
use crate::manifest::{EfficientdetHead, Scores};
use scaleproof_core::geometry::BoxPx;
use scaleproof_core::message::Message;

const STRIDES: [u32; 5] = [8, 16, 32, 64, 128];

/// Width and height in parts of an anchor's side.
const ASPECTS: [[f32; 2]; 3] = [[1.0, 1.0], [1.4, 0.7], [0.7, 1.4]];

/// Counts the anchors of an input of width × height `size` in pixels.
pub fn count(size: [u32; 2]) -> usize {
    let cells = STRIDES.map(|stride| size.map(|side| side.div_ceil(stride) as usize));
    9 * cells.map(|[columns, rows]| columns * rows).iter().sum::<usize>()
}

/// Exports that add the anchors themselves call them so. COCO's 90 category ids from 1 on, and no other list, may be one fewer than the labels.
pub(super) fn anchors(
    outputs: &[Tensor],
    size: [u32; 2],
    head: EfficientdetHead,
    labels: usize,
) -> Result<Anchors, Message> {
    let found = match grids(outputs, size) {
        Some(grids) if grids.labels == labels || (grids.labels, labels) == (90, 91) => {
            of_grids(outputs, size, head, &grids)
        }
        _ => of_tables(outputs, size, head, labels)?,
    };
    Ok(Anchors {
        are_logits: head.scores == Scores::Logits,
        first_scored: labels - found.1,
        ..Anchors::new(found.0)
    })
}

struct Grid {
    scores: usize,
    offsets: usize,
    /// Columns · rows.
    cells: usize,
}

pub struct Grids {
    of: Vec<Grid>,
    /// Labels that they have scores for.
    pub labels: usize,
}

impl Grids {
    pub fn scores(&self) -> impl Iterator<Item = usize> {
        self.of.iter().map(|grid| grid.scores)
    }
}

/// The pairs of grids among some outputs. With four labels both of a pair are alike; scores come first then, as effdet gives them.
pub fn grids(outputs: &[Tensor], size: [u32; 2]) -> Option<Grids> {
    let of_stride = |stride: u32| {
        let [columns, rows] = size.map(|side| side.div_ceil(stride) as usize);
        let is_grid =
            |t: &Tensor| matches!(t.shape[..], [1, c, h, w] if [w, h] == [columns, rows] && c % 9 == 0 && c > 0);
        let has_grid = |i: &usize| is_grid(&outputs[*i]) && outputs[*i].floats().is_some();
        let both: Vec<usize> = (0..outputs.len()).filter(has_grid).collect();
        let [first, second] = both[..] else { return None };
        let (scores, offsets) = if outputs[second].shape[1] == 36 {
            (first, second)
        } else {
            (second, first)
        };
        let cells = columns * rows;
        (outputs[offsets].shape[1] == 36).then_some(Grid { scores, offsets, cells })
    };
    let of: Vec<Grid> = STRIDES.into_iter().map(of_stride).collect::<Option<_>>()?;
    let labels = |grid: &Grid| outputs[grid.scores].shape[1] / 9;
    let first = labels(of.first()?);
    let is_one_network = of.iter().all(|grid| labels(grid) == first) && outputs.len() == 2 * of.len();
    is_one_network.then_some(Grids { of, labels: first })
}

/// Anchors, and how many labels they have scores for.
type Found = (Vec<Anchor>, usize);

/// Decodes grids: of each cell's channels the offsets are four for each of nine anchors, the scores one for each label of each.
fn of_grids(outputs: &[Tensor], size: [u32; 2], head: EfficientdetHead, grids: &Grids) -> Found {
    let mut own = own_boxes(size, head.anchor_scale as f32);
    let mut found = Vec::new();
    for Grid { scores, offsets, cells } in &grids.of {
        let numbers = outputs[*offsets].floats().unwrap_or_default();
        let of_anchor = |(i, own): (usize, [f32; 4])| {
            let (cell, nth) = (i / 9, i % 9);
            let offsets = [0, 1, 2, 3].map(|k| numbers[(4 * nth + k) * cells + cell]);
            Anchor::new(
                moved(own, offsets),
                *scores,
                None,
                nth * grids.labels * cells + cell,
                *cells,
            )
        };
        found.extend(own.by_ref().take(9 * cells).enumerate().map(of_anchor));
    }
    (found, grids.labels)
}

/// The box that offsets (y, x, height, width) make of an anchor's own.
fn moved([cx, cy, w, h]: [f32; 4], o: [f32; 4]) -> BoxPx {
    centred([cx + o[1] * w, cy + o[0] * h, o[3].exp() * w, o[2].exp() * h])
}

fn of_tables(outputs: &[Tensor], size: [u32; 2], head: EfficientdetHead, labels: usize) -> Result<Found, Message> {
    let rows = count(size);
    let find = || {
        let is_table = |t: &Tensor| !t.name.contains("anchor") && t.floats().is_some();
        let at = outputs.iter().position(|t| t.shape == [1, rows, 4] && is_table(t))?;
        let has_columns = |columns: usize| columns == labels || (columns, labels) == (90, 91);
        let fits = |t: &Tensor| matches!(t.shape[..], [1, n, columns] if n == rows && has_columns(columns));
        let mut others = outputs.iter().enumerate().filter(|(i, t)| *i != at && is_table(t));
        let (output, scores) = others.find(|(_, t)| fits(t))?;
        // With four labels both tables are alike: the offsets must then be named.
        let is_named = ["box", "reg"].iter().any(|name| outputs[at].name.contains(name));
        (labels != 4 || is_named).then_some((outputs[at].floats()?, output, scores.shape[2]))
    };
    let (offsets, output, columns) = find().ok_or_else(|| {
        let expected = format!("1×{rows}×4 and 1×{rows}×{labels}, or ten grids");
        misfit("efficientdet", expected, outputs)
    })?;
    let boxes = own_boxes(size, head.anchor_scale as f32).zip(offsets.as_chunks::<4>().0);
    let of_row = |(i, (own, offsets)): (usize, ([f32; 4], &[f32; 4]))| {
        Anchor::new(moved(own, *offsets), output, None, i * columns, 1)
    };
    Ok((boxes.enumerate().map(of_row).collect(), columns))
}

/// The anchors' centres and sizes in input pixels: by stride, row, column, size, aspect. Where a last row or column is cut, all cells of its
/// grid are smaller.
fn own_boxes([width, height]: [u32; 2], anchor_scale: f32) -> impl Iterator<Item = [f32; 4]> {
    STRIDES.into_iter().flat_map(move |stride| {
        let (columns, rows) = (width.div_ceil(stride), height.div_ceil(stride));
        let step = [width as f32 / columns as f32, height as f32 / rows as f32];
        (0..columns * rows * 9).map(move |i| {
            let (cell, kind) = (i / 9, i % 9);
            let octave = anchor_scale * 2_f32.powf((kind / 3) as f32 / 3.0);
            let aspect = ASPECTS[(kind % 3) as usize];
            let [w, h] = [0, 1].map(|axis| aspect[axis] * octave * step[axis]);
            let centre = |cell: u32, axis: usize| (cell as f32 + 0.5) * step[axis];
            [centre(cell % columns, 0), centre(cell / columns, 1), w, h]
        })
    })
}
