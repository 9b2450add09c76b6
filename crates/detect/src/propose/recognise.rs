//! The families that a network's outputs could be of, by their shapes and names.

use super::details::{floats, listed_boxes};
use super::family::Family;
use super::inspect::Inspected;
use crate::heads::{BINS, Pair, TENSORFLOW, Tensor, efficientdet, ssd};
use crate::manifest::Layout;

#[derive(Debug, Clone, PartialEq)]
pub(super) struct FamilyCandidate {
    pub family: Family,
    /// Number of labels that the shapes have room for; `None` where they do not say.
    pub labels: Option<usize>,
    /// Strides, of the families whose manifests name them.
    pub strides: Vec<u32>,
}

/// The grids that the one-stage families with one table use.
const STRIDES: [&[u32]; 3] = [&[8, 16, 32], &[8, 16, 32, 64], &[16, 32, 64]];

/// Grids of small networks, which have no finer one.
const COARSE: [&[u32]; 2] = [&[16, 32], &[32, 64]];

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

pub(super) fn by_shape(network: &Inspected) -> Vec<FamilyCandidate> {
    let (outputs, size) = (&network.answers[0], network.size_px);
    let is_named = |name: &str| outputs.iter().any(|t| t.name.split(':').next() == Some(name));
    let bare = |family, labels: Option<usize>| labels.map(|labels| FamilyCandidate::new(family, Some(labels), &[]));
    if TENSORFLOW[..3].iter().all(|name| is_named(name)) {
        return vec![FamilyCandidate::new(Family::TfOd, None, &[])];
    }
    if let Some(boxes) = listed_boxes(outputs) {
        let families = listing(network, boxes).into_iter();
        return families.map(|family| FamilyCandidate::new(family, None, &[])).collect();
    }
    if tflite(network).is_some() {
        return vec![FamilyCandidate::new(Family::TfliteSsd, None, &[])];
    }
    let of_planes = |shape: &[usize], grid: [usize; 2], boxes: usize| match shape {
        [1, row, rows, columns] if [*columns, *rows] == grid && row % boxes == 0 => (row / boxes).checked_sub(5),
        _ => None,
    };
    let in_grids = |strides: &[u32]| {
        let labels = labels_of_grids(outputs, size, strides, |shape, grid| match shape {
            [1, 3, rows, columns, row] | [1, rows, columns, 3, row] if [*columns, *rows] == grid => row.checked_sub(5),
            [1, rows, columns, row] if [*columns, *rows] == grid && row % 3 == 0 => (row / 3).checked_sub(5),
            _ => of_planes(shape, grid, 3),
        });
        labels.filter(|_| outputs.len() == strides.len())
    };
    let fastestdet = labels_of_grids(outputs, size, &[16], |shape, grid| of_planes(shape, grid, 1));
    let (three, two) = (in_grids(&[8, 16, 32]), in_grids(&[16, 32]));
    let is_zoo = outputs.iter().all(|t| matches!(t.shape[..], [1, _, _, 3, _]));
    let mut of_grids = vec![
        bare(Family::Yolov4, three.filter(|_| is_zoo)),
        bare(Family::Fastestdet, fastestdet.filter(|_| outputs.len() == 1)),
        bare(Family::Yolov3, three.filter(|_| !is_zoo)),
        bare(Family::Efficientdet, efficientdet(outputs, size)),
    ];
    of_grids.extend([Family::Yolov3Tiny, Family::Yolov4Tiny, Family::YoloFastest].map(|family| bare(family, two)));
    let mut found: Vec<FamilyCandidate> = of_grids.into_iter().flatten().collect();
    found.extend(by_distances(network));
    if !found.is_empty() {
        return found;
    }
    let is_of_transformers = is_named("logits") && is_named("pred_boxes");
    let is_detr = is_of_transformers || is_named("pred_logits") && is_named("pred_boxes");
    let is_sampling = network.file.samples || is_named("enc_topk_logits");
    let pair = Pair::find(outputs, |columns| columns > 0);
    match pair {
        // RT-DETR, D-FINE and Deformable DETR score by a sigmoid and sample their features; DETR and YOLOS score by a softmax over their labels and
        // "no object", and Conditional DETR by a sigmoid. Neither of these samples, and no number tells them apart.
        Some(pair) if is_detr && !is_sampling => {
            let softmax = FamilyCandidate::new(Family::Detr, pair.columns.checked_sub(1), &[]);
            let sigmoid = |family| FamilyCandidate::new(family, Some(pair.columns), &[]);
            vec![softmax, sigmoid(Family::ConditionalDetr), sigmoid(Family::HfDetr)]
        }
        Some(pair) if is_of_transformers => vec![FamilyCandidate::new(Family::HfDetr, Some(pair.columns), &[])],
        // Queries are a few hundred, prior boxes and cells more.
        Some(pair) if pair.rows <= MOST_QUERIES && outputs[pair.boxes].shape.len() == 3 => {
            vec![FamilyCandidate::new(Family::Rfdetr, Some(pair.columns), &[])]
        }
        Some(pair) => {
            let is_grid = |grids: &[&[u32]], times: usize| grids.iter().any(|s| times * cells(size, s) == pair.rows);
            let is_of_anchors = outputs[pair.boxes].shape.len() == 4 || is_grid(&STRIDES, 3) || is_grid(&COARSE, 3);
            let is_of_priors = ssd::priors(outputs, size, pair.rows).is_some();
            let families: &[Family] = match (is_of_anchors && !is_of_priors, is_grid(&STRIDES, 1)) {
                (true, _) => &[Family::Yolov4Pytorch],
                (false, true) => &[Family::Yolov4Pytorch, Family::Ssd],
                (false, false) => &[Family::Ssd],
            };
            let of = |family: &Family| FamilyCandidate::new(*family, Some(pair.columns), &[]);
            families.iter().map(of).collect()
        }
        None => outputs.iter().flat_map(|t| one_table(t, network)).collect(),
    }
}

/// No DETR has more rows.
const MOST_QUERIES: usize = 1000;

/// The outputs that hold boxes, labels, scores and their number, of a network that ends with TFLite's operator, whatever they are called: four tables of
/// floats, of which the labels are whole numbers in both answers and the scores are not.
pub(super) fn tflite(network: &Inspected) -> Option<[String; 4]> {
    let outputs = &network.answers[0];
    let sides = |t: &Tensor| t.shape.iter().copied().filter(|side| *side != 1).collect::<Vec<_>>();
    let boxes = outputs
        .iter()
        .position(|t| t.shape.len() == 3 && t.shape[2] == 4 && t.floats().is_some())?;
    let rows = outputs[boxes].shape[1];
    let count = outputs.iter().position(|t| sides(t).is_empty() && t.shape.len() < 2)?;
    let lists: Vec<usize> = (0..outputs.len()).filter(|i| ![boxes, count].contains(i)).collect();
    let [a, b] = lists[..] else { return None };
    let is_list = |i: usize| outputs[i].shape == [1, rows] && outputs[i].floats().is_some();
    let is_whole = |i: usize| {
        network
            .answers
            .iter()
            .all(|answer| floats(&answer[i]).all(|v| v.fract() == 0.0))
    };
    if outputs.len() != 4 || !is_list(a) || !is_list(b) {
        return None;
    }
    let (labels, scores) = match [is_whole(a), is_whole(b)] {
        [true, false] => (a, b),
        [false, true] => (b, a),
        // Where nothing was found all are 0, and the operator's own order is left.
        [true, true] if outputs[a].name.ends_with(":1") && outputs[b].name.ends_with("PostProcess:2") => (a, b),
        _ => return None,
    };
    Some([boxes, labels, scores, count].map(|i| outputs[i].name.clone()))
}

/// NanoDet or PicoDet, which have the same tables. PicoDet comes from PaddlePaddle and has a batch axis and a fourth grid; where its file does not say where
/// it comes from any more, both could be meant.
fn by_distances(network: &Inspected) -> Vec<FamilyCandidate> {
    let Some(found) = nanodet(&network.answers[0], network.size_px) else {
        return Vec::new();
    };
    let outputs = &network.answers[0];
    let is_of_paddle = |name: &str| name.starts_with("save_infer_model") || name.contains(".tmp_");
    let picodet = FamilyCandidate {
        family: Family::Picodet,
        ..found.clone()
    };
    if network.file.made_by.contains("paddle") || outputs.iter().any(|t| is_of_paddle(&t.name)) {
        vec![picodet]
    } else if found.strides.len() > 3 && outputs.iter().all(|t| t.shape.len() == 3) {
        vec![found, picodet]
    } else {
        vec![found]
    }
}

/// Returns how many labels outputs have room for that are grids at these strides, all of as many; `room` is that of a shape for a grid of some
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

fn cells([width, height]: [u32; 2], strides: &[u32]) -> usize {
    let of = |s: &u32| width.div_ceil(*s) * height.div_ceil(*s);
    strides.iter().map(of).sum::<u32>() as usize
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
    if let Some(grids) = efficientdet::grids(outputs, size) {
        return Some(if grids.labels == 90 { 91 } else { grids.labels });
    }
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

/// The families that answer with one table; older exports add the grids it was made from.
fn one_table(table: &Tensor, network: &Inspected) -> Vec<FamilyCandidate> {
    let [1, first, last] = table.shape[..] else {
        return Vec::new();
    };
    let size = network.size_px;
    let mut found = Vec::new();
    let mut push = |family, labels, strides: &[u32]| found.push(FamilyCandidate::new(family, labels, strides));
    let is_grid = |n: usize, times: usize| STRIDES.iter().any(|s| times * cells(size, s) == n);
    let is_coarse = COARSE.iter().any(|s| 3 * cells(size, s) == first);
    if last > 5 && (network.file.made_by.contains("darknet") || is_coarse) {
        return vec![FamilyCandidate::new(Family::Darknet, Some(last - 5), &[])];
    }
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
    let is_ssd = ssd::priors(&[], size, last).is_some();
    if is_grid(last, 1) && first > 4 {
        push(Family::Yolov8, Some(first - 4), &[]);
    } else if is_ssd && first > 4 {
        push(Family::SsdTable, Some(first - 4), &[]);
    }
    if !one_a_cell && !three_a_cell && !is_grid(last, 1) && !is_ssd {
        match last {
            6 => push(Family::Yolov10, None, &[]),
            _ if last > 4 && first <= MOST_QUERIES => push(Family::Rtdetr, Some(last - 4), &[]),
            _ => {}
        }
    }
    found
}

/// Returns what outputs the families would have for an input of this size, as a clause.
pub(super) fn needs(size: [u32; 2]) -> String {
    let rows = |strides: &[&[u32]], times: usize| {
        let all = strides.iter().map(|s| (times * cells(size, s)).to_string());
        all.collect::<Vec<_>>().join(" or ")
    };
    let grid = |stride: u32| format!("{}×{}", size[1] / stride, size[0] / stride);
    let (one, three, coarse) = (rows(&STRIDES, 1), rows(&STRIDES, 3), rows(&COARSE, 3));
    let (cells, anchors) = (rows(&STRIDES[..2], 1), efficientdet::count(size));
    [
        format!("YOLOv5 to v7 would have a table 1×n×(5 + labels) of n = {three} rows"),
        format!("Darknet's small YOLOs one of {coarse}"),
        format!("YOLOX one of {one}"),
        format!("NanoDet-Plus 1×n×(labels + {}) of {one}", 4 * BINS),
        format!("YOLOv8 to 12 a table 1×(4 + labels)×n of n = {one} columns"),
        "YOLOv10 and 26 1×n×6".to_owned(),
        format!("RT-DETR of Ultralytics 1×n×(4 + labels) of up to {MOST_QUERIES} rows"),
        format!("YOLOv3 and v4 three grids {}, {} and {}", grid(8), grid(16), grid(32)),
        format!("FastestDet one of {}", grid(16)),
        format!(
            "NanoDet and PicoDet n×labels and n×{} for each stride ({cells} cells in all)",
            4 * BINS
        ),
        format!("EfficientDet 1×{anchors}×4 and 1×{anchors}×labels, or ten grids of 9·labels and 36 channels"),
        format!("SSDs boxes 1×n×4 and scores 1×n×labels of more than {MOST_QUERIES} rows, and DETRs of fewer"),
        format!("TensorFlow's API {}", TENSORFLOW[..3].join(", ")),
        "and R-CNNs, DEIM and torchvision boxes n×4, scores n and labels n as whole numbers".to_owned(),
    ]
    .join(", ")
}
