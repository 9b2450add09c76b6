//! Networks that give boxes in one output and the scores of all labels in another, one row a box: SSD before its postprocessing, and YOLOs
//! exported that way.
//!
//! The background, where it has a column, has the first one. Offsets are from prior boxes, which some exports give as an output and which else
//! follow from the input's size. Source: TensorFlow's Object Detection API, `multiple_grid_anchor_generator.py`, `multiscale_grid_anchor_generator.py`,
//! `faster_rcnn_box_coder.py`.

use super::anchor::{Anchor, Anchors, centred, scaled};
use super::error::misfit;
use super::tensor::Tensor;
use crate::manifest::{Scores, SsdBoxes, SsdHead};
use scaleproof_core::geometry::BoxPx;
use scaleproof_core::message::Message;

/// The outputs of a head with boxes and scores apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Pair {
    /// Index of the output with the boxes, 1×n×4 or 1×n×1×4.
    pub boxes: usize,
    /// Index of the output with the scores, 1×n×columns.
    pub scores: usize,
    pub rows: usize,
    pub columns: usize,
}

impl Pair {
    /// The boxes and the scores among some outputs. `fits`: of the columns of the scores. With four columns too the boxes are named so.
    pub(crate) fn find(outputs: &[Tensor], fits: impl Fn(usize) -> bool) -> Option<Pair> {
        let is_float = |t: &&(usize, &Tensor)| t.1.floats().is_some() && !is_prior(t.1);
        let tables: Vec<(usize, &Tensor)> = outputs.iter().enumerate().filter(|t| is_float(&t)).collect();
        let rows = |t: &Tensor| match t.shape[..] {
            [1, n, 4] | [1, n, 1, 4] => Some(n),
            _ => None,
        };
        let is_named = |t: &Tensor| ["box", "loc"].iter().any(|name| t.name.to_lowercase().contains(name));
        let of_four = tables.iter().filter_map(|(i, t)| Some((*i, rows(t)?, is_named(t))));
        let (boxes, rows, is_named) = of_four.max_by_key(|(i, _, is_named)| (*is_named, std::cmp::Reverse(*i)))?;
        tables.iter().find_map(|(i, t)| match t.shape[..] {
            [1, n, columns] if *i != boxes && n == rows && fits(columns) && (columns != 4 || is_named) => Some(Pair {
                boxes,
                scores: *i,
                rows,
                columns,
            }),
            _ => None,
        })
    }
}

fn is_prior(t: &Tensor) -> bool {
    ["anchor", "prior"]
        .iter()
        .any(|name| t.name.to_lowercase().contains(name))
}

/// Returns whether so many columns hold the scores of these labels: one each, one more for the background, or COCO's 90 category ids from 1 on.
pub(crate) fn has_room(columns: usize, labels: usize) -> bool {
    columns == labels || columns == labels + 1 || (columns, labels) == (90, 91)
}

pub(super) fn anchors(outputs: &[Tensor], size: [u32; 2], head: SsdHead, labels: usize) -> Result<Anchors, Message> {
    let refused = || {
        let expected = format!("boxes 1×n×4 and scores 1×n×{labels} or 1×n×{}", labels + 1);
        misfit("ssd", expected, outputs)
    };
    let pair = Pair::find(outputs, |columns| has_room(columns, labels)).ok_or_else(refused)?;
    let boxes = outputs[pair.boxes].floats().ok_or_else(refused)?.as_chunks::<4>().0;
    let decoded: Vec<BoxPx> = match head.boxes {
        SsdBoxes::Offsets => {
            let priors = priors(outputs, size, pair.rows).ok_or_else(|| {
                let expected = format!("as many rows as an input of {}×{} has prior boxes", size[0], size[1]);
                misfit("ssd", expected, outputs)
            })?;
            boxes
                .iter()
                .zip(priors)
                .map(|(o, prior)| scaled(of_offsets(*o, prior), size))
                .collect()
        }
        SsdBoxes::Yxyx => (boxes.iter())
            .map(|[y1, x1, y2, x2]| scaled([*x1, *y1, *x2, *y2].map(f64::from).into(), size))
            .collect(),
        SsdBoxes::Xyxy => boxes.iter().map(|b| scaled(b.map(f64::from).into(), size)).collect(),
        SsdBoxes::XyxyPixels => boxes.iter().map(|b| b.map(f64::from).into()).collect(),
    };
    let background = usize::from(pair.columns == labels + 1);
    let anchor = |(i, b): (usize, BoxPx)| Anchor::new(b, pair.scores, None, i * pair.columns + background, 1);
    let mut found = Anchors {
        are_logits: head.scores == Scores::Logits,
        first_scored: usize::from((pair.columns, labels) == (90, 91)),
        ..Anchors::new(decoded.into_iter().enumerate().map(anchor).collect())
    };
    // COCO's ids leave 0 out, where these networks have the background.
    if (pair.columns, labels) == (91, 91) {
        found.first_scored = 1;
        found.anchors.iter_mut().for_each(|anchor| anchor.first_label += 1);
    }
    Ok(found)
}

/// Offsets in tenths of the prior's side and fifths of its logarithm.
fn of_offsets([y, x, h, w]: [f32; 4], [cx, cy, width, height]: [f32; 4]) -> BoxPx {
    centred([
        x / 10.0 * width + cx,
        y / 10.0 * height + cy,
        (w / 5.0).exp() * width,
        (h / 5.0).exp() * height,
    ])
}

/// The prior boxes, centre and size as shares of the input: those that the file gives (y, x, height, width, as TFLite's operator takes them), else
/// those of one of the two generators that has so many.
pub(crate) fn priors(outputs: &[Tensor], size: [u32; 2], rows: usize) -> Option<Vec<[f32; 4]>> {
    let given = outputs
        .iter()
        .find(|t| is_prior(t) && t.shape.iter().product::<usize>() == 4 * rows);
    if let Some(given) = given.and_then(Tensor::floats) {
        return Some(
            given
                .as_chunks()
                .0
                .iter()
                .map(|[y, x, h, w]| [*x, *y, *w, *h])
                .collect(),
        );
    }
    [multiple_grids(size), multiscale(size)]
        .into_iter()
        .find(|priors| priors.len() == rows)
}

/// SSD's own: six grids of ⌈side / 16⌉ cells and half as many each time, scales from 0.2 to 0.95, the lowest grid with three boxes a cell.
fn multiple_grids([width, height]: [u32; 2]) -> Vec<[f32; 4]> {
    let scale = |i: u32| if i == 6 { 1.0 } else { 0.2 + 0.15 * i as f32 };
    let mut found = Vec::new();
    let mut cells = [width, height].map(|side| side.div_ceil(16));
    let shorter = width.min(height) as f32;
    for i in 0..6 {
        let of_cell: Vec<(f32, f32)> = if i == 0 {
            vec![(0.1, 1.0), (scale(0), 2.0), (scale(0), 0.5)]
        } else {
            let aspects = [1.0, 2.0, 0.5, 3.0, 0.3333].map(|aspect| (scale(i), aspect));
            let between = (scale(i) * scale(i + 1)).sqrt();
            aspects.into_iter().chain([(between, 1.0)]).collect()
        };
        for cell in 0..cells[0] * cells[1] {
            let centre = |cell: u32, axis: usize| (cell as f32 + 0.5) / cells[axis] as f32;
            let [x, y] = [centre(cell % cells[0], 0), centre(cell / cells[0], 1)];
            found.extend(of_cell.iter().map(|(scale, aspect)| {
                let [w, h] = [scale * aspect.sqrt(), scale / aspect.sqrt()];
                [x, y, w * shorter / width as f32, h * shorter / height as f32]
            }));
        }
        cells = cells.map(|side| side.div_ceil(2));
    }
    found
}

/// RetinaNet's, of SSDs with a feature pyramid: strides 8 to 128, two sizes of 4 strides and √2 times that, aspects 1, 2 and ½.
fn multiscale(size: [u32; 2]) -> Vec<[f32; 4]> {
    let sides = size.map(|side| side as f32);
    let mut found = Vec::new();
    for stride in [8_u32, 16, 32, 64, 128] {
        let [columns, rows] = size.map(|side| side.div_ceil(stride));
        for cell in 0..columns * rows {
            // The generator shifts a grid by half a stride where the stride divides the side, else not at all.
            let centre = |cell: u32, axis: usize| {
                let shift = if size[axis].is_multiple_of(stride) { 0.5 } else { 0.0 };
                (cell as f32 + shift) * stride as f32 / sides[axis]
            };
            let [x, y] = [centre(cell % columns, 0), centre(cell / columns, 1)];
            for (aspect, scale) in [1.0, 2.0, 0.5]
                .into_iter()
                .flat_map(|a: f32| [1.0, 2.0_f32.sqrt()].map(|s| (a, s)))
            {
                let side = 4.0 * stride as f32 * scale;
                found.push([x, y, side * aspect.sqrt() / sides[0], side / aspect.sqrt() / sides[1]]);
            }
        }
    }
    found
}
