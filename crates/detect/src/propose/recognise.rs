//! Which families a network's outputs could be of: by their shapes and names, then by the range of their numbers.

use super::family::Family;
use super::inspect::Inspected;
use crate::heads::{Data, Tensor, efficientdet};
use crate::manifest::{Layout, Scores};

/// A family whose outputs have these shapes.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct FamilyCandidate {
    pub family: Family,
    /// How many labels the shapes have room for; `None` where they do not say.
    pub labels: Option<usize>,
    /// Of the families whose manifests name them.
    pub strides: Vec<u32>,
}

/// The grids that the one-stage families with one table use.
const STRIDES: [&[u32]; 3] = [&[8, 16, 32], &[8, 16, 32, 64], &[16, 32, 64]];

/// Every family with outputs of these shapes.
pub(super) fn by_shape(network: &Inspected) -> Vec<FamilyCandidate> {
    let outputs = &network.answers[0];
    let candidate = |family, labels| FamilyCandidate {
        family,
        labels,
        strides: Vec::new(),
    };
    if named(outputs, "detection_boxes") && named(outputs, "detection_classes") && named(outputs, "detection_scores") {
        return vec![candidate(Family::TfOd, None)];
    }
    if let Some(rows) = listed_boxes(outputs) {
        return listing(network, rows).into_iter().map(|f| candidate(f, None)).collect();
    }
    let mut found = Vec::new();
    found.extend(yolov4(outputs, network.size_px).map(|labels| candidate(Family::Yolov4, Some(labels))));
    found.extend(fastestdet(outputs, network.size_px).map(|labels| candidate(Family::Fastestdet, Some(labels))));
    found.extend(nanodet(outputs, network.size_px));
    found.extend(yolov3(outputs, network.size_px).map(|labels| candidate(Family::Yolov3, Some(labels))));
    found.extend(efficientdet(outputs, network.size_px).map(|labels| candidate(Family::Efficientdet, Some(labels))));
    if found.is_empty() {
        let is_of_transformers = named(outputs, "logits") && named(outputs, "pred_boxes");
        match rfdetr(outputs) {
            // 91 labels and "no object" are DETR's own, whose scores are a softmax: what reads these shapes would read them wrongly.
            Some(92) if is_of_transformers => return Vec::new(),
            Some(columns) if is_of_transformers => found.push(candidate(Family::HfDetr, Some(columns))),
            Some(columns) => found.push(candidate(Family::Rfdetr, Some(columns))),
            None => {}
        }
    }
    if found.is_empty() {
        found.extend(outputs.iter().flat_map(|t| one_table(t, network.size_px)));
    }
    found
}

fn named(outputs: &[Tensor], name: &str) -> bool {
    outputs.iter().any(|t| t.name.split(':').next() == Some(name))
}

/// Cells of all grids of an input.
fn cells([width, height]: [u32; 2], strides: &[u32]) -> usize {
    let of = |s: &u32| width.div_ceil(*s) * height.div_ceil(*s);
    strides.iter().map(of).sum::<u32>() as usize
}

/// The boxes among outputs that list labels, boxes and scores.
fn listed_boxes(outputs: &[Tensor]) -> Option<&Tensor> {
    let whole = outputs.iter().find(|t| matches!(t.data, Data::I64(_)))?;
    let count: usize = whole.shape.iter().product();
    let is_boxes = |t: &&Tensor| t.shape.last() == Some(&4) && t.shape.iter().product::<usize>() == 4 * count;
    outputs.iter().find(is_boxes)
}

/// Families that list their boxes. R-CNNs take an image without a batch axis or list their boxes without one.
fn listing(network: &Inspected, boxes: &Tensor) -> Vec<Family> {
    if network.takes_photo_size {
        return vec![Family::Deim];
    }
    let digits = |t: &Tensor| !t.name.is_empty() && t.name.chars().all(|c| c.is_ascii_digit());
    match (boxes.shape.len(), network.layout != Layout::Chw) {
        (3, true) => vec![Family::SsdResnet34],
        (_, true) => vec![Family::Torchvision],
        // The zoo's outputs have no names but the numbers that the exporter of its time gave them.
        (_, false) if network.answers[0].iter().all(digits) => vec![Family::ZooRcnn],
        (_, false) if boxes.name == "boxes" => vec![Family::Torchvision],
        (_, false) => vec![Family::ZooRcnn, Family::Torchvision],
    }
}

fn yolov4(outputs: &[Tensor], [width, height]: [u32; 2]) -> Option<usize> {
    let grid = |s: u32| {
        let is_grid = |shape: &[usize]| match shape {
            [1, rows, columns, 3, row] if *row > 5 => {
                ([*columns, *rows] == [width / s, height / s].map(|v| v as usize)).then_some(row - 5)
            }
            _ => None,
        };
        outputs.iter().find_map(|t| is_grid(&t.shape))
    };
    let labels = grid(8)?;
    (grid(16) == Some(labels) && grid(32) == Some(labels)).then_some(labels)
}

fn fastestdet(outputs: &[Tensor], [width, height]: [u32; 2]) -> Option<usize> {
    match (outputs.len(), &outputs.first()?.shape[..]) {
        (1, [1, row, rows, columns]) if *row > 5 => {
            ([*columns, *rows] == [width / 16, height / 16].map(|v| v as usize)).then_some(row - 5)
        }
        _ => None,
    }
}

fn yolov3(outputs: &[Tensor], [width, height]: [u32; 2]) -> Option<usize> {
    let labels = |s: u32| {
        let of_grid = |t: &Tensor| match t.shape[..] {
            [1, row, rows, columns] if [columns, rows] == [width / s, height / s].map(|v| v as usize) => {
                (row % 3 == 0).then(|| (row / 3).checked_sub(5)).flatten()
            }
            _ => None,
        };
        outputs.iter().find_map(of_grid).filter(|labels| *labels > 0)
    };
    let found = labels(8)?;
    (outputs.len() == 3 && labels(16) == Some(found) && labels(32) == Some(found)).then_some(found)
}

fn efficientdet(outputs: &[Tensor], size: [u32; 2]) -> Option<usize> {
    let rows = efficientdet::count(size);
    let columns = |t: &Tensor| match t.shape[..] {
        [1, n, columns] if n == rows => Some(columns),
        _ => None,
    };
    let has_boxes = outputs.iter().any(|t| columns(t) == Some(4));
    let scores = outputs.iter().filter_map(columns).find(|columns| *columns != 4)?;
    // COCO's category ids from 1 on.
    has_boxes.then_some(if scores == 90 { 91 } else { scores })
}

/// Whether the scores of an EfficientDet are logits; exports may give its features beside them.
pub(super) fn scores(network: &Inspected) -> Scores {
    let rows = efficientdet::count(network.size_px);
    let is_scores = |t: &&Tensor| matches!(t.shape[..], [1, n, columns] if n == rows && columns != 4);
    let tables = network.answers.iter().flatten().filter(is_scores);
    match no_score(tables.flat_map(|t| floats(t).iter().copied())) {
        Some(_) => Scores::Logits,
        None => Scores::Probabilities,
    }
}

/// A pair of tables per stride.
fn nanodet(outputs: &[Tensor], size: [u32; 2]) -> Option<FamilyCandidate> {
    const BOX_LOGITS: usize = 32;
    let of_stride = |stride: u32| -> Vec<usize> {
        let count = cells(size, &[stride]);
        let rows = outputs.iter().filter_map(|t| match t.shape[..] {
            [1, n, row] | [n, row] if n == count => Some(row),
            _ => None,
        });
        rows.collect()
    };
    let labels_of = |stride: &u32| {
        let rows = of_stride(*stride);
        let at = rows.iter().position(|row| *row == BOX_LOGITS)?;
        match (rows.len(), at) {
            (2, at) => Some(rows[1 - at]),
            _ => None,
        }
    };
    let strides = [4, 8, 16, 32, 64, 128].into_iter();
    let (strides, labels): (Vec<u32>, Vec<usize>) = strides.filter_map(|s| Some((s, labels_of(&s)?))).unzip();
    let are_alike = labels.iter().all(|l| *l == labels[0]);
    (!strides.is_empty() && are_alike && outputs.len() == 2 * strides.len()).then(|| FamilyCandidate {
        family: Family::Nanodet,
        labels: labels.first().copied(),
        strides,
    })
}

/// Boxes 1×n×4 beside logits 1×n×columns.
fn rfdetr(outputs: &[Tensor]) -> Option<usize> {
    let of = |t: &Tensor| match t.shape[..] {
        [1, n, columns] => Some((n, columns)),
        _ => None,
    };
    let [a, b] = [of(outputs.first()?)?, of(outputs.get(1)?)?];
    match (outputs.len(), a, b) {
        (2, (n, 4), (m, columns)) | (2, (n, columns), (m, 4)) if n == m => Some(columns),
        _ => None,
    }
}

/// The families that answer with one table; older exports add the grids it was made from.
fn one_table(table: &Tensor, size: [u32; 2]) -> Vec<FamilyCandidate> {
    let [1, first, last] = table.shape[..] else {
        return Vec::new();
    };
    let mut found = Vec::new();
    let mut push = |family, labels: Option<usize>, strides: &[u32]| {
        found.push(FamilyCandidate {
            family,
            labels,
            strides: strides.to_vec(),
        });
    };
    let is_grid = |n: usize, times: usize| STRIDES.iter().any(|s| times * cells(size, s) == n);
    for strides in STRIDES.iter().filter(|s| cells(size, s) == first && last > 32) {
        push(Family::NanodetPlus, Some(last - 32), strides);
    }
    let (one_a_cell, three_a_cell) = (is_grid(first, 1), is_grid(first, 3));
    if three_a_cell && last > 5 {
        push(Family::Yolov5, Some(last - 5), &[]);
    }
    if one_a_cell && last > 5 {
        push(Family::Yolox, Some(last - 5), &[]);
        push(Family::YoloxDecoded, Some(last - 5), &[]);
        push(Family::Yolov5, Some(last - 5), &[]);
    }
    if is_grid(last, 1) && first > 4 {
        push(Family::Yolov8, Some(first - 4), &[]);
    }
    if !one_a_cell && !three_a_cell && !is_grid(last, 1) {
        match last {
            6 => push(Family::Yolov10, None, &[]),
            _ if last > 4 => push(Family::Rtdetr, Some(last - 4), &[]),
            _ => {}
        }
    }
    found
}

/// Why the numbers cannot be this family's, as what was found; `None` where nothing speaks against it.
pub(super) fn against(candidate: &FamilyCandidate, network: &Inspected) -> Option<String> {
    network.answers.iter().find_map(|outputs| match candidate.family {
        Family::Yolov4 => outputs.iter().find_map(|t| no_score(columns(t, 4..))),
        Family::Yolov5 | Family::YoloxDecoded => {
            let t = table(outputs, candidate.labels? + 5)?;
            no_score(columns(t, 4..)).or_else(|| not_decoded(t, network.size_px))
        }
        Family::Yolox => {
            let t = table(outputs, candidate.labels? + 5)?;
            no_score(columns(t, 4..)).or_else(|| decoded(t))
        }
        Family::Yolov8 => {
            let t = outputs
                .iter()
                .find(|t| t.shape.get(1) == Some(&(candidate.labels.unwrap_or(0) + 4)))?;
            let n = *t.shape.last()?;
            no_score(floats(t).iter().skip(4 * n).copied())
        }
        Family::Yolov10 => {
            let t = table(outputs, 6)?;
            let labels = columns(t, 5..).find(|l| l.fract() != 0.0);
            let label = labels.map(|l| format!("its last column has {l}, which is no label"));
            label.or_else(|| no_score(columns(t, 4..5)))
        }
        Family::Nanodet => {
            let scores = outputs.iter().filter(|t| t.shape.last() == candidate.labels.as_ref());
            scores.into_iter().find_map(|t| no_score(floats(t).iter().copied()))
        }
        Family::NanodetPlus => no_score(columns(table(outputs, candidate.labels? + 32)?, 0..candidate.labels?)),
        Family::Fastestdet => {
            let t = outputs.first()?;
            let plane: usize = t.shape.get(2..)?.iter().product();
            let scores = floats(t).iter().enumerate();
            no_score(scores.filter(|(i, _)| i / plane == 0 || i / plane > 4).map(|(_, v)| *v))
        }
        Family::Rtdetr => {
            let t = table(outputs, candidate.labels? + 4)?;
            no_score(columns(t, 4..)).or_else(|| no_share(columns(t, 0..4)))
        }
        Family::Rfdetr | Family::HfDetr => {
            let logits = outputs.iter().find(|t| t.shape.last() != Some(&4))?;
            let probabilities = no_score(floats(logits).iter().copied()).is_none();
            let text = format!(
                "its scores are probabilities already, and {} gives logits",
                candidate.family.title()
            );
            probabilities
                .then_some(text)
                .or_else(|| no_share(floats(table(outputs, 4)?).iter().copied()))
        }
        Family::SsdResnet34 => no_share(floats(listed_boxes(outputs)?).iter().copied()),
        Family::Yolov3 => {
            let probabilities = no_score(outputs.iter().flat_map(|t| floats(t).iter().copied())).is_none();
            probabilities.then(|| "its numbers are probabilities already, and YOLOv3's grids are logits".to_owned())
        }
        Family::Efficientdet | Family::Deim | Family::TfOd | Family::ZooRcnn | Family::Torchvision => None,
    })
}

fn floats(t: &Tensor) -> &[f32] {
    match &t.data {
        Data::F32(v) => v,
        Data::I64(_) => &[],
    }
}

fn table(outputs: &[Tensor], row: usize) -> Option<&Tensor> {
    outputs
        .iter()
        .find(|t| t.shape.len() == 3 && t.shape.last() == Some(&row))
}

/// The numbers in some columns of a table.
fn columns(t: &Tensor, of: impl std::ops::RangeBounds<usize>) -> impl Iterator<Item = f32> {
    let row = t.shape.last().copied().unwrap_or(1).max(1);
    let all = floats(t).iter().enumerate();
    all.filter(move |(i, _)| of.contains(&(i % row))).map(|(_, v)| *v)
}

/// A number that is no probability; rounding may leave one a hair outside.
fn no_score(mut values: impl Iterator<Item = f32>) -> Option<String> {
    let outside = values.find(|v| !(-1e-3..=1.001).contains(v))?;
    Some(format!("a score is {outside}: was it exported without its sigmoid?"))
}

/// A coordinate that is no share of the image's side; boxes may reach beyond the image.
fn no_share(mut values: impl Iterator<Item = f32>) -> Option<String> {
    let outside = values.find(|v| !(-2.0..=3.0).contains(v))?;
    Some(format!("a coordinate is {outside}, which is no share of the image"))
}

/// Raw YOLOX: sizes are logarithms, of which the largest an image allows is ln(8192 / 8).
fn decoded(t: &Tensor) -> Option<String> {
    let outside = columns(t, 2..4).find(|v| *v > 7.0)?;
    Some(format!(
        "a box's size is {outside}, which is no logarithm: it is decoded already"
    ))
}

/// Decoded boxes have sizes of pixels, nearly all above 0, and centres all over the image.
fn not_decoded(t: &Tensor, [width, _]: [u32; 2]) -> Option<String> {
    let negative = columns(t, 2..4).find(|v| *v < 0.0);
    let widest = columns(t, 0..1).fold(0.0, f32::max);
    let text = |what: String| Some(format!("{what}: its boxes are not decoded"));
    match negative {
        Some(v) => text(format!("a box's size is {v}")),
        None if widest < width as f32 / 4.0 => text(format!("no box's centre lies beyond {widest} pixels")),
        None => None,
    }
}
