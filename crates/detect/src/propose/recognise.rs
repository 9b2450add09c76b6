//! Which families a network's outputs could be of: by their shapes and names, then by the range of their numbers.

use super::family::Family;
use super::inspect::Inspected;
use crate::heads::{BINS, Data, Tensor, efficientdet};
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

impl FamilyCandidate {
    fn new(family: Family, labels: Option<usize>, strides: &[u32]) -> FamilyCandidate {
        let strides = strides.to_vec();
        FamilyCandidate {
            family,
            labels,
            strides,
        }
    }
}

/// Every family with outputs of these shapes.
pub(super) fn by_shape(network: &Inspected) -> Vec<FamilyCandidate> {
    let (outputs, size) = (&network.answers[0], network.size_px);
    let is_named = |name: &str| outputs.iter().any(|t| t.name.split(':').next() == Some(name));
    let bare = |family, labels: Option<usize>| labels.map(|labels| FamilyCandidate::new(family, Some(labels), &[]));
    if ["detection_boxes", "detection_classes", "detection_scores"]
        .into_iter()
        .all(is_named)
    {
        return vec![FamilyCandidate::new(Family::TfOd, None, &[])];
    }
    if let Some(boxes) = listed_boxes(outputs) {
        let families = listing(network, boxes).into_iter();
        return families.map(|family| FamilyCandidate::new(family, None, &[])).collect();
    }
    let yolov4 = labels_of_grids(outputs, size, &[8, 16, 32], |shape, grid| match shape {
        [1, rows, columns, 3, row] if [*columns, *rows] == grid => row.checked_sub(5),
        _ => None,
    });
    let of_planes = |shape: &[usize], grid: [usize; 2], boxes: usize| match shape {
        [1, row, rows, columns] if [*columns, *rows] == grid && row % boxes == 0 => (row / boxes).checked_sub(5),
        _ => None,
    };
    let fastestdet = labels_of_grids(outputs, size, &[16], |shape, grid| of_planes(shape, grid, 1));
    let yolov3 = labels_of_grids(outputs, size, &[8, 16, 32], |shape, grid| of_planes(shape, grid, 3));
    let of_grids = [
        bare(Family::Yolov4, yolov4),
        bare(Family::Fastestdet, fastestdet.filter(|_| outputs.len() == 1)),
        nanodet(outputs, size),
        bare(Family::Yolov3, yolov3.filter(|_| outputs.len() == 3)),
        bare(Family::Efficientdet, efficientdet(outputs, size)),
    ];
    let found: Vec<FamilyCandidate> = of_grids.into_iter().flatten().collect();
    if !found.is_empty() {
        return found;
    }
    let is_of_transformers = is_named("logits") && is_named("pred_boxes");
    match rfdetr(outputs) {
        // 91 labels and "no object" are DETR's own, whose scores are a softmax: what reads these shapes would read them wrongly.
        Some(92) if is_of_transformers => Vec::new(),
        Some(columns) if is_of_transformers => vec![FamilyCandidate::new(Family::HfDetr, Some(columns), &[])],
        Some(columns) => vec![FamilyCandidate::new(Family::Rfdetr, Some(columns), &[])],
        None => outputs.iter().flat_map(|t| one_table(t, size)).collect(),
    }
}

/// How many labels outputs have room for that are grids at these strides, all of as many; `room` is that of a shape for a grid of some
/// columns and rows.
fn labels_of_grids(
    outputs: &[Tensor],
    size: [u32; 2],
    strides: &[u32],
    room: impl Fn(&[usize], [usize; 2]) -> Option<usize>,
) -> Option<usize> {
    let labels = |stride: &u32| {
        let grid = size.map(|side| (side / stride) as usize);
        let mut rooms = outputs.iter().filter_map(|t| room(&t.shape, grid));
        rooms.find(|labels| *labels > 0)
    };
    let found = labels(strides.first()?)?;
    let are_alike = strides.iter().all(|stride| labels(stride) == Some(found));
    are_alike.then_some(found)
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
    if network.takes.takes_photo_size {
        return vec![Family::Deim];
    }
    let digits = |t: &Tensor| !t.name.is_empty() && t.name.chars().all(|c| c.is_ascii_digit());
    match (boxes.shape.len(), network.takes.layout != Layout::Chw) {
        (3, true) => vec![Family::SsdResnet34],
        (_, true) => vec![Family::Torchvision],
        // The zoo's outputs have no names but the numbers that the exporter of its time gave them.
        (_, false) if network.answers[0].iter().all(digits) => vec![Family::ZooRcnn],
        (_, false) if boxes.name == "boxes" => vec![Family::Torchvision],
        (_, false) => vec![Family::ZooRcnn, Family::Torchvision],
    }
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
    if no_score(tables.flat_map(floats)).is_some() {
        Scores::Logits
    } else {
        Scores::Probabilities
    }
}

/// A pair of tables per stride.
fn nanodet(outputs: &[Tensor], size: [u32; 2]) -> Option<FamilyCandidate> {
    let labels_at = |stride: u32| {
        let count = cells(size, &[stride]);
        let rows = outputs.iter().filter_map(|t| match t.shape[..] {
            [1, n, row] | [n, row] if n == count => Some(row),
            _ => None,
        });
        match rows.collect::<Vec<usize>>()[..] {
            [row, labels] | [labels, row] if row == 4 * BINS => Some((stride, labels)),
            _ => None,
        }
    };
    let (strides, labels): (Vec<u32>, Vec<usize>) = [4, 8, 16, 32, 64, 128].into_iter().filter_map(labels_at).unzip();
    let are_alike = labels.iter().all(|l| *l == labels[0]);
    let is_found = !strides.is_empty() && are_alike && outputs.len() == 2 * strides.len();
    is_found.then(|| FamilyCandidate::new(Family::Nanodet, labels.first().copied(), &strides))
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
    let mut push = |family, labels, strides: &[u32]| found.push(FamilyCandidate::new(family, labels, strides));
    let is_grid = |n: usize, times: usize| STRIDES.iter().any(|s| times * cells(size, s) == n);
    for strides in STRIDES.iter().filter(|s| cells(size, s) == first && last > 4 * BINS) {
        push(Family::NanodetPlus, Some(last - 4 * BINS), strides);
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
    let (family, labels) = (candidate.family, candidate.labels);
    network.answers.iter().find_map(|outputs| match family {
        Family::Yolov4 => outputs.iter().find_map(|t| no_score(columns(t, 4..))),
        Family::Yolov5 | Family::YoloxDecoded | Family::Yolox => {
            let t = table(outputs, labels? + 5)?;
            no_score(columns(t, 4..)).or_else(|| match family {
                Family::Yolox => decoded(t),
                _ => not_decoded(t, network.size_px),
            })
        }
        Family::Yolov8 => {
            let rows = labels? + 4;
            let t = outputs.iter().find(|t| t.shape.get(1) == Some(&rows))?;
            no_score(floats(t).skip(4 * t.shape.last()?))
        }
        Family::Yolov10 => {
            let t = table(outputs, 6)?;
            let labels = columns(t, 5..).find(|l| l.fract() != 0.0);
            let label = labels.map(|l| format!("its last column has {l}, which is no label"));
            label.or_else(|| no_score(columns(t, 4..5)))
        }
        Family::Nanodet => {
            let mut scores = outputs.iter().filter(|t| t.shape.last() == labels.as_ref());
            scores.find_map(|t| no_score(floats(t)))
        }
        Family::NanodetPlus => no_score(columns(table(outputs, labels? + 4 * BINS)?, 0..labels?)),
        Family::Fastestdet => {
            let t = outputs.first()?;
            let plane: usize = t.shape.get(2..)?.iter().product();
            let scores = floats(t).enumerate().filter(|(i, _)| i / plane == 0 || i / plane > 4);
            no_score(scores.map(|(_, v)| v))
        }
        Family::Rtdetr => {
            let t = table(outputs, labels? + 4)?;
            no_score(columns(t, 4..)).or_else(|| no_share(columns(t, 0..4)))
        }
        Family::Rfdetr | Family::HfDetr => {
            let logits = outputs.iter().find(|t| t.shape.last() != Some(&4))?;
            if no_score(floats(logits)).is_some() {
                return no_share(floats(table(outputs, 4)?));
            }
            let gives = format!("{} gives logits", family.title());
            Some(format!("its scores are probabilities already, and {gives}"))
        }
        Family::SsdResnet34 => no_share(floats(listed_boxes(outputs)?)),
        Family::Yolov3 => {
            let probabilities = no_score(outputs.iter().flat_map(floats)).is_none();
            probabilities.then(|| "its numbers are probabilities already, and YOLOv3's grids are logits".to_owned())
        }
        Family::Efficientdet | Family::Deim | Family::TfOd | Family::ZooRcnn | Family::Torchvision => None,
    })
}

/// Its values, where they are fractions.
fn floats(t: &Tensor) -> impl Iterator<Item = f32> {
    t.floats().unwrap_or_default().iter().copied()
}

fn table(outputs: &[Tensor], row: usize) -> Option<&Tensor> {
    let is_table = |t: &&Tensor| t.shape.len() == 3 && t.shape.last() == Some(&row);
    outputs.iter().find(is_table)
}

/// The numbers in some columns of a table.
fn columns(t: &Tensor, of: impl std::ops::RangeBounds<usize>) -> impl Iterator<Item = f32> {
    let row = t.shape.last().copied().unwrap_or(1).max(1);
    let all = floats(t).enumerate();
    all.filter(move |(i, _)| of.contains(&(i % row))).map(|(_, v)| v)
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
    let widest = columns(t, 0..1).fold(0.0, f32::max);
    let what = match columns(t, 2..4).find(|v| *v < 0.0) {
        Some(v) => format!("a box's size is {v}"),
        None if widest < width as f32 / 4.0 => format!("no box's centre lies beyond {widest} pixels"),
        None => return None,
    };
    Some(format!("{what}: its boxes are not decoded"))
}
