//! Output tensors in, candidate boxes out, by the form in which networks answer: tables, grids, distances, lists, or boxes of their own choice.

mod distances;
pub(super) mod efficientdet;
mod grids;
mod listed;
mod queries;
pub(super) mod ssd;
mod tables;

pub(super) use distances::BINS;
use listed::Rows;
pub(super) use listed::TENSORFLOW;
pub(super) use ssd::{Pair, has_room};

use super::SCORE_FLOOR;
use super::manifest::{AnchorLabels, Head, Manifest};
use super::nms::CandidateBox;
use scaleproof_core::geometry::BoxPx;

#[derive(Debug, Clone)]
pub struct Tensor {
    pub name: String,
    pub shape: Vec<usize>,
    pub data: Data,
}

#[derive(Debug, Clone)]
pub enum Data {
    F32(Vec<f32>),
    I64(Vec<i64>),
}

impl Tensor {
    /// The first of some outputs that has fractions and such a shape: its number and its values.
    fn shaped(outputs: &[Tensor], fits: impl Fn(&[usize]) -> bool) -> Option<(usize, &[f32])> {
        let mut shaped = outputs.iter().enumerate().filter(|(_, t)| fits(&t.shape));
        shaped.find_map(|(i, t)| Some((i, t.floats()?)))
    }

    /// Its values, where they are fractions.
    pub fn floats(&self) -> Option<&[f32]> {
        match &self.data {
            Data::F32(v) => Some(v),
            Data::I64(_) => None,
        }
    }
}

/// A box, and where in the outputs its scores lie.
#[derive(Debug, Clone, PartialEq)]
pub struct Anchor {
    /// In input pixels; not always solid.
    pub b: BoxPx,
    pub output: usize,
    /// Index of its objectness, in heads that have one.
    pub objectness: Option<usize>,
    /// Index of its first label's score, or of its only one.
    pub first_label: usize,
    /// The only label it has a score for, in heads that name it.
    pub label: Option<usize>,
    /// From one label's score to the next.
    pub label_step: usize,
}

/// All boxes of a head that leaves the choice among them to its user.
pub struct Anchors {
    pub anchors: Vec<Anchor>,
    /// score = objectness^exponents\[0\] · label^exponents\[1\]
    pub exponents: [f32; 2],
    /// Whether both are the sigmoids of the outputs' numbers.
    pub are_logits: bool,
    /// Which of the labels the first score is of: 1 where the list begins with the background and the outputs do not.
    pub first_scored: usize,
    /// Whether each label of an anchor that reaches the score floor is a detection, or the best alone.
    pub keeps: AnchorLabels,
}

impl Anchor {
    fn new(b: BoxPx, output: usize, objectness: Option<usize>, first_label: usize, label_step: usize) -> Anchor {
        Anchor {
            b,
            output,
            objectness,
            first_label,
            label: None,
            label_step,
        }
    }
}

impl Anchors {
    fn new(anchors: Vec<Anchor>) -> Anchors {
        Anchors {
            anchors,
            exponents: [1.0, 1.0],
            are_logits: false,
            first_scored: 0,
            keeps: AnchorLabels::Best,
        }
    }

    /// The label of an anchor that scores best, of so many, and its number in the output.
    pub fn best_label(&self, anchor: &Anchor, output: &[f32], labels: usize) -> (usize, f32) {
        let scores = output[anchor.first_label..]
            .iter()
            .step_by(anchor.label_step)
            .take(labels - self.first_scored);
        let (nth, best) = best(scores.copied());
        (nth + self.first_scored, best)
    }

    /// The labels of each anchor that are kept and reach the score floor.
    fn candidates(&self, outputs: &[Tensor], labels: usize) -> Vec<CandidateBox> {
        let score = |number: f32| if self.are_logits { sigmoid(number) } else { number };
        let power = |score: f32, exponent: f32| if exponent == 1.0 { score } else { score.powf(exponent) };
        let mut found = Vec::new();
        for anchor in &self.anchors {
            let Some(data) = outputs.get(anchor.output).and_then(Tensor::floats) else {
                continue;
            };
            let objectness = anchor
                .objectness
                .map_or(1.0, |i| power(score(data[i]), self.exponents[0]));
            let candidate = |label: usize, number: f32| {
                from_corners(label, objectness * power(score(number), self.exponents[1]), anchor.b)
            };
            match self.keeps {
                AnchorLabels::Best => {
                    let (label, number) = self.best_label(anchor, data, labels);
                    found.extend(candidate(label, number));
                }
                // Most anchors see nothing, and no label of theirs can reach the floor.
                AnchorLabels::All if f64::from(objectness) < SCORE_FLOOR => {}
                AnchorLabels::All => {
                    let numbers = data[anchor.first_label..].iter().step_by(anchor.label_step);
                    let labelled = (self.first_scored..labels).zip(numbers);
                    found.extend(labelled.filter_map(|(label, number)| candidate(label, *number)));
                }
            }
        }
        found
    }
}

/// The anchors of a detector's outputs for an input of width × height `size` in pixels; `None` for heads that choose their boxes by
/// themselves.
pub fn anchors(manifest: &Manifest, outputs: &[Tensor], size: [u32; 2]) -> Result<Option<Anchors>, HeadError> {
    let labels = manifest.labels.count();
    let found = match &manifest.head {
        Head::Yolox(_) => tables::yolox(outputs, size, labels)?,
        Head::Nanodet(head) => distances::nanodet(outputs, size, &head.strides, labels)?,
        Head::Picodet(head) => distances::picodet(outputs, size, &head.strides, labels)?,
        Head::NanodetPlus(head) => tables::nanodet_plus(outputs, size, &head.strides, labels)?,
        Head::Fastestdet(_) => grids::fastestdet(outputs, size, labels)?,
        Head::Yolov3(head) => grids::yolov3(outputs, size, labels, &head.grids)?,
        Head::Efficientdet(head) => efficientdet::anchors(outputs, size, *head, labels)?,
        Head::Rfdetr {} => queries::rfdetr_anchors(outputs, size, labels)?,
        Head::Yolov4(head) => grids::yolov4(outputs, size, labels, &head.grids)?,
        Head::Yolov5(head) => tables::yolov5(outputs, size, labels, head.boxes)?,
        Head::Yolov8(head) => tables::yolov8(outputs, size, labels, head.boxes)?,
        Head::Ssd(head) => ssd::anchors(outputs, size, *head, labels)?,
        Head::Rtdetr { .. } => tables::rtdetr(outputs, size, labels)?,
        Head::Deim {} => Anchors::new(deim(outputs)?.anchors(labels)),
        Head::Yolov10 {} => queries::yolov10_anchors(outputs, labels)?,
        _ => return Ok(None),
    };
    let keeps = manifest.head.anchor_labels();
    Ok(Some(Anchors { keeps, ..found }))
}

/// DEIM, D-FINE, RT-DETR exports with `orig_target_sizes`: boxes x1 y1 x2 y2 in photo pixels.
fn deim(outputs: &[Tensor]) -> Result<Rows<'_>, HeadError> {
    Rows::pick(outputs, "deim", "labels 1×n, boxes 1×n×4, scores 1×n")
}

/// Why outputs have no boxes to read.
#[derive(Debug, thiserror::Error)]
pub enum HeadError {
    #[error("its outputs {found} are not those of a {kind} head ({expected}): the manifest does not fit this file")]
    Misfit {
        kind: &'static str,
        expected: String,
        found: String,
    },
    #[error(
        "it answered with label {label}, which is not among the {labels} of its manifest: `labels` or `first_label` is another network's"
    )]
    StrangeLabel { label: String, labels: usize },
    #[error("it answered with {what}")]
    NotFinite {
        /// A box that is not finite, and in which output.
        what: String,
    },
}

/// The candidates in a detector's outputs for an input of width × height `size` in pixels, in input pixels; in photo pixels where
/// [`wants_photo_size`].
pub fn candidates(manifest: &Manifest, outputs: &[Tensor], size: [u32; 2]) -> Result<Vec<CandidateBox>, HeadError> {
    let labels = manifest.labels.count();
    let mut candidates = match &manifest.head {
        Head::Yolov10 {} => queries::yolov10(outputs, labels)?,
        Head::Rfdetr {} => queries::rfdetr(outputs, size, labels)?,
        Head::Detr {} => queries::detr(outputs, size, labels)?,
        Head::Deim {} => deim(outputs)?.candidates(0, labels, BoxPx::from)?,
        // Boxes y1 x1 y2 x2 as shares of the photo; classes are floats, counted from 1. Source: the API's `exporter`.
        Head::TfOd(head) => {
            let rows = Rows::of_tensorflow(outputs, head.outputs.as_ref())?;
            rows.candidates(head.first_label, labels, |[y1, x1, y2, x2]| {
                scaled(BoxPx::new(x1, y1, x2, y2), size)
            })?
        }
        // Boxes x1 y1 x2 y2 as shares of the input. Source: the ONNX zoo's page on the model for the shapes; MLPerf's reference for the order
        // (mlcommons/inference, `PostProcessCocoOnnx`, which swaps each pair to read it as TensorFlow's y1 x1 y2 x2).
        Head::SsdResnet34(first) => {
            let expected = "boxes 1×n×4, whole-number labels 1×n, scores 1×n";
            let rows = Rows::pick(outputs, "ssd_resnet34", expected)?;
            rows.candidates(first.first_label, labels, |b| scaled(b.into(), size))?
        }
        // Faster and Mask R-CNN (ONNX zoo, torchvision) and torchvision's SSD and RetinaNet: boxes x1 y1 x2 y2 in input pixels; masks are not
        // used. Source: the zoo's page on Faster R-CNN; torchvision's detection models.
        Head::Rcnn(first) => {
            let rows = Rows::pick(outputs, "rcnn", "boxes n×4, whole-number labels n, scores n")?;
            rows.candidates(first.first_label, labels, BoxPx::from)?
        }
        _ => anchors(manifest, outputs, size)?.map_or_else(Vec::new, |a| a.candidates(outputs, labels)),
    };
    // Numbers in the gaps of a list mean nothing, and no file could keep them.
    candidates.retain(|c| manifest.labels.name(c.label).is_some());
    let Some(c) = candidates.iter().find(|c| !is_finite(&c.b)) else {
        return Ok(candidates);
    };
    // Numbers that are minus infinity or have grown beyond all bounds, such as e^1000; the output where only one can have them.
    let floats: Vec<&Tensor> = outputs.iter().filter(|t| t.floats().is_some()).collect();
    let place = match floats[..] {
        [only] => format!(" in its output {}", only.name),
        _ => String::new(),
    };
    let what = format!("a box that is not finite ({:?}){place}", <[f64; 4]>::from(c.b));
    Err(HeadError::NotFinite { what })
}

/// A NaN or an infinity and the first output that holds it, as the end of the sentence "it answered with …". Minus infinity is a logit
/// like any other; in a box, [`candidates`] finds it.
pub(super) fn with_no_number(outputs: &[Tensor]) -> Option<String> {
    outputs.iter().find_map(|tensor| {
        let bad = |v: &&f32| v.is_nan() || **v == f32::INFINITY;
        let value = tensor.floats()?.iter().find(bad)?;
        let value = if value.is_nan() { "NaN" } else { "infinity" };
        Some(format!("{value} in its output {}", tensor.name))
    })
}

fn is_finite(b: &BoxPx) -> bool {
    <[f64; 4]>::from(*b).iter().all(|v| v.is_finite())
}

/// Does the detector want the photo's size as a second input?
pub fn wants_photo_size(head: &Head) -> bool {
    matches!(head, Head::Deim {})
}

fn scaled(b: BoxPx, [width, height]: [u32; 2]) -> BoxPx {
    let (w, h) = (f64::from(width), f64::from(height));
    BoxPx::new(b.x1 * w, b.y1 * h, b.x2 * w, b.y2 * h)
}

fn centred([cx, cy, w, h]: [f32; 4]) -> BoxPx {
    let [cx, cy, w, h] = [cx, cy, w, h].map(f64::from);
    BoxPx::new(cx - w / 2.0, cy - h / 2.0, cx + w / 2.0, cy + h / 2.0)
}

/// A candidate; `None` below the score floor and for a box without an area. A box that is not finite stays: [`candidates`] refuses the
/// whole answer, since dropping it would make a network that fails look like one that finds nothing.
fn from_corners(label: usize, score: f32, b: BoxPx) -> Option<CandidateBox> {
    let score = f64::from(score);
    (score >= SCORE_FLOOR && (b.is_solid() || !is_finite(&b))).then_some(CandidateBox { label, score, b })
}

/// The best label and its score; the first of equals. NaN scores never win.
fn best(scores: impl Iterator<Item = f32>) -> (usize, f32) {
    let first = (0, f32::NEG_INFINITY);
    let better = |best: (usize, f32), (i, s)| if s > best.1 { (i, s) } else { best };
    scores.enumerate().fold(first, better)
}

fn sigmoid(x: f32) -> f32 {
    1.0 / (1.0 + (-x).exp())
}

/// The refusal every head gives when the outputs are not what the manifest says.
fn misfit(kind: &'static str, expected: String, outputs: &[Tensor]) -> HeadError {
    let found = outputs
        .iter()
        .map(|t| format!("{} {:?}", t.name, t.shape).trim_start().to_owned())
        .collect::<Vec<_>>()
        .join(", ");
    HeadError::Misfit { kind, expected, found }
}
