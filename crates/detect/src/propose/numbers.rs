//! Tests whether a network's numbers can be those of a family whose shapes it has: scores, logits, pixels, shares.

use super::details::{self, columns, floats, listed_boxes, table};
use super::family::Family;
use super::inspect::Inspected;
use super::recognise::FamilyCandidate;
use crate::heads::{BINS, Pair, TENSORFLOW, Tensor, efficientdet};
use crate::manifest::{Scores, SsdBoxes};

/// Why the numbers cannot be this family's, as what was found; `None` where nothing speaks against it.
pub(super) fn against(candidate: &FamilyCandidate, network: &Inspected) -> Option<String> {
    let (family, labels, size) = (candidate.family, candidate.labels, network.size_px);
    network.answers.iter().find_map(|outputs| match family {
        Family::Yolov4 => outputs.iter().find_map(|t| no_score(columns(t, 4..))),
        Family::Yolov5 | Family::YoloxDecoded | Family::Yolox | Family::Darknet => {
            let t = table(outputs, labels? + 5)?;
            no_score(columns(t, 4..)).or_else(|| match family {
                Family::Yolox => decoded(t),
                _ => not_decoded([0, 2].map(|at| columns(t, at..at + 2).collect()), size),
            })
        }
        Family::Yolov8 | Family::SsdTable => {
            let rows = labels? + 4;
            let t = outputs.iter().find(|t| t.shape.get(1) == Some(&rows))?;
            let n = *t.shape.last()?;
            let sides = [0, 2 * n].map(|from| floats(t).skip(from).take(2 * n).collect());
            no_score(floats(t).skip(4 * n)).or_else(|| not_decoded(sides, size))
        }
        Family::Yolov10 => {
            let t = table(outputs, 6)?;
            let labels = columns(t, 5..).find(|l| l.fract() != 0.0);
            let label = labels.map(|l| format!("its last column has {l}, which is no label"));
            label
                .or_else(|| no_score(columns(t, 4..5)))
                .or_else(|| no_corners(t, 6))
        }
        Family::Nanodet | Family::Picodet => {
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
        Family::Rfdetr | Family::HfDetr | Family::Detr | Family::ConditionalDetr => {
            let pair = Pair::find(outputs, |columns| columns > 0)?;
            if no_score(floats(&outputs[pair.scores])).is_some() {
                return no_share(floats(&outputs[pair.boxes]));
            }
            let gives = format!("{} gives logits", family.title());
            Some(format!("its scores are probabilities already, and {gives}"))
        }
        Family::Yolov4Pytorch | Family::Ssd => {
            let pair = Pair::find(outputs, |columns| Some(columns) == labels)?;
            let is_bad_score = || no_score(floats(&outputs[pair.scores])).filter(|_| family == Family::Yolov4Pytorch);
            match details::ssd_boxes(outputs, pair, size) {
                None => Some(format!(
                    "its boxes are neither decoded nor {} offsets from the prior boxes of an input of {}×{}",
                    pair.rows, size[0], size[1]
                )),
                Some(SsdBoxes::Offsets) if family == Family::Yolov4Pytorch => Some("its boxes are not decoded".into()),
                Some(_) => is_bad_score(),
            }
        }
        Family::SsdResnet34 => no_share(floats(listed_boxes(outputs)?)),
        Family::TfOd => no_share(floats(outputs.iter().find(|t| t.name.starts_with(TENSORFLOW[0]))?)),
        Family::TfliteSsd => no_share(floats(outputs.iter().find(|t| t.shape.len() == 3)?)),
        Family::Yolov3 | Family::Yolov3Tiny | Family::Yolov4Tiny | Family::YoloFastest => {
            let probabilities = no_score(outputs.iter().flat_map(floats)).is_none();
            probabilities.then(|| "its numbers are probabilities already, and Darknet's grids are logits".to_owned())
        }
        Family::Deim | Family::ZooRcnn | Family::Torchvision => no_corners(listed_boxes(outputs)?, 4),
        Family::Efficientdet => None,
    })
}

/// Returns whether the scores of an EfficientDet are logits; exports may give its features beside them.
pub(super) fn scores(network: &Inspected) -> Scores {
    let rows = efficientdet::count(network.size_px);
    let is_scores = |t: &&Tensor| matches!(t.shape[..], [1, n, columns] if n == rows && columns != 4);
    let scores_of = |outputs: &'_ [Tensor]| -> Vec<f32> {
        match efficientdet::grids(outputs, network.size_px) {
            Some(grids) => grids.scores().flat_map(|i| floats(&outputs[i])).collect(),
            None => outputs.iter().filter(is_scores).flat_map(floats).collect(),
        }
    };
    scores_by(no_score(network.answers.iter().flat_map(|outputs| scores_of(outputs))).is_some())
}

fn scores_by(are_logits: bool) -> Scores {
    if are_logits {
        Scores::Logits
    } else {
        Scores::Probabilities
    }
}

/// Returns whether the scores beside some boxes are logits.
pub(super) fn pair_scores(network: &Inspected, labels: Option<usize>) -> Scores {
    let of = |outputs: &[Tensor]| {
        let pair = Pair::find(outputs, |columns| Some(columns) == labels)?;
        no_score(floats(&outputs[pair.scores]))
    };
    scores_by(network.answers.iter().any(|outputs| of(outputs).is_some()))
}

/// Centres and sizes of the boxes of a family with one table, of both answers.
pub(super) fn boxes<'a>(candidate: &'a FamilyCandidate, network: &'a Inspected) -> impl Iterator<Item = f32> + 'a {
    let labels = candidate.labels.unwrap_or_default();
    network.answers.iter().flat_map(move |outputs| -> Vec<f32> {
        let by_columns = outputs.iter().find(|t| t.shape.len() == 3 && t.shape[1] == labels + 4);
        match by_columns.filter(|_| candidate.family != Family::Yolov5) {
            Some(t) => floats(t).take(4 * t.shape[2]).collect(),
            None => table(outputs, labels + 5).map_or_else(Vec::new, |t| columns(t, 0..4).collect()),
        }
    })
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

/// Decoded boxes have sizes above 0 and centres all over the image, in pixels or in shares of it. YOLO26's distances come from a convolution
/// alone (`reg_max` is 1), which leaves some sizes negative where nothing is seen: in pixels most sizes decide. `sides`: all centres, then all sizes.
fn not_decoded([centres, sizes]: [Vec<f32>; 2], [width, _]: [u32; 2]) -> Option<String> {
    let widest = centres.iter().copied().fold(0.0, f32::max);
    let are_shares = centres.iter().chain(&sizes).all(|v| details::SHARES.contains(v));
    let negative = || sizes.iter().filter(|v| **v < 0.0);
    let are_most_negative = 2 * negative().count() > sizes.len();
    let what = match negative().next() {
        Some(v) if are_shares || are_most_negative => format!("a box's size is {v}"),
        _ if are_shares && spread(&centres) > 0.2 => return None,
        _ if widest < width as f32 / 4.0 => format!("no box's centre lies beyond {widest} pixels"),
        _ => return None,
    };
    Some(format!("{what}: its boxes are not decoded"))
}

/// The standard deviation of some numbers: of numbers all over 0 to 1 it is near 0.29.
fn spread(values: &[f32]) -> f32 {
    let count = values.len().max(1) as f32;
    let mean = values.iter().sum::<f32>() / count;
    (values.iter().map(|v| (v - mean).powi(2)).sum::<f32>() / count).sqrt()
}

/// Corners in pixels of boxes that end before they begin, or that all lie within a pixel or two; `row`: numbers a box. Of lists that no network cleaned,
/// rows of six, most boxes decide: where YOLO26 sees nothing, some are turned round.
fn no_corners(t: &Tensor, row: usize) -> Option<String> {
    let all: Vec<f32> = floats(t).collect();
    let boxes = || all.chunks_exact(row);
    let turned = || boxes().filter(|b| b[2] < b[0] - 1.0 || b[3] < b[1] - 1.0);
    let is_padding = |b: &&[f32]| b[..4].iter().all(|v| *v == 0.0);
    let are_few = row == 6 && 2 * turned().count() <= boxes().filter(|b| !is_padding(b)).count();
    if let Some(b) = turned().next().filter(|_| !are_few) {
        return Some(format!("a box ends before it begins ({:?})", &b[..4]));
    }
    let is_tiny = !all.is_empty() && boxes().all(|b| b[..4].iter().all(|v| details::SHARES.contains(v)));
    let is_empty = boxes().all(|b| b[..4].iter().all(|v| *v == 0.0));
    (is_tiny && !is_empty).then(|| "its boxes are shares of the image, not pixels".to_owned())
}
