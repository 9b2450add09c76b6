//! One file per output layout: tensors in, candidates out.

mod deim;
mod fastestdet;
mod nanodet;
mod nanodet_plus;
mod rcnn;
mod rfdetr;
mod rows;
mod rtdetr;
mod ssd_resnet34;
mod tf_od;
mod yolov10;
mod yolov4;
mod yolov5;
mod yolov8;
mod yolox;

use super::SCORE_FLOOR;
use super::manifest::{Head, Manifest};
use super::nms::{self, Candidate};
use crate::geometry::BoxPx;

/// One output tensor, row-major.
#[derive(Debug, Clone)]
pub(super) struct Tensor {
    pub name: String,
    pub shape: Vec<usize>,
    pub data: Data,
}

#[derive(Debug, Clone)]
pub(super) enum Data {
    F32(Vec<f32>),
    I64(Vec<i64>),
}

impl Tensor {
    fn floats(&self) -> Option<&[f32]> {
        match &self.data {
            Data::F32(v) => Some(v),
            Data::I64(_) => None,
        }
    }

    #[cfg(test)]
    fn of_floats(shape: &[usize], data: Vec<f32>) -> Tensor {
        Tensor {
            name: String::new(),
            shape: shape.to_vec(),
            data: Data::F32(data),
        }
    }
}

/// Candidates in input pixels for most heads; DEIM answers in photo pixels.
pub(super) struct Decoded {
    /// Best first.
    pub candidates: Vec<Candidate>,
    pub in_photo_px: bool,
}

/// Reads a detector's outputs for an input of width × height `size` in pixels.
pub(super) fn decode(manifest: &Manifest, outputs: &[Tensor], size: [u32; 2]) -> Result<Decoded, String> {
    let labels = manifest.labels.count();
    let (mut candidates, nms_iou) = match &manifest.head {
        Head::Yolox { nms_iou } => (yolox::decode(outputs, size, labels)?, Some(nms_iou)),
        Head::Nanodet { strides, nms_iou } => (nanodet::decode(outputs, size, strides, labels)?, Some(nms_iou)),
        Head::NanodetPlus { strides, nms_iou } => {
            (nanodet_plus::decode(outputs, size, strides, labels)?, Some(nms_iou))
        }
        Head::Fastestdet { nms_iou } => (fastestdet::decode(outputs, size, labels)?, Some(nms_iou)),
        Head::Yolov4 { nms_iou } => (yolov4::decode(outputs, size, labels)?, Some(nms_iou)),
        Head::Yolov5 { nms_iou } => (yolov5::decode(outputs, labels)?, Some(nms_iou)),
        Head::Yolov8 { nms_iou } => (yolov8::decode(outputs, labels)?, Some(nms_iou)),
        Head::Yolov10 {} => (yolov10::decode(outputs, labels)?, None),
        Head::Deim {} => (deim::decode(outputs, labels)?, None),
        Head::Rtdetr {} => (rtdetr::decode(outputs, size, labels)?, None),
        Head::Rfdetr {} => (rfdetr::decode(outputs, size, labels)?, None),
        Head::TfOd(first) => (tf_od::decode(outputs, size, first.first_label, labels)?, None),
        Head::SsdResnet34(first) => (ssd_resnet34::decode(outputs, size, first.first_label, labels)?, None),
        Head::Rcnn(first) => (rcnn::decode(outputs, first.first_label, labels)?, None),
    };
    // Numbers in the gaps of a list mean nothing, and no file could keep them.
    candidates.retain(|c| manifest.labels.name(c.label).is_some());
    Ok(Decoded {
        candidates: match nms_iou {
            Some(iou) => nms::suppress(candidates, *iou),
            None => nms::sorted(candidates),
        },
        in_photo_px: matches!(manifest.head, Head::Deim {}),
    })
}

/// The name of the first output that holds a NaN or an infinity, and which of them. Minus infinity is a logit like any other.
pub(super) fn with_no_number(outputs: &[Tensor]) -> Option<(&str, &'static str)> {
    outputs.iter().find_map(|tensor| {
        let bad = |v: &&f32| v.is_nan() || **v == f32::INFINITY;
        let value = tensor.floats()?.iter().find(bad)?;
        Some((tensor.name.as_str(), if value.is_nan() { "NaN" } else { "infinity" }))
    })
}

/// Does the detector want the photo's size as a second input?
pub(super) fn wants_photo_size(head: &Head) -> bool {
    matches!(head, Head::Deim {})
}

/// A box in shares of an input's width and height, in pixels.
fn scaled(b: BoxPx, [width, height]: [u32; 2]) -> BoxPx {
    let (w, h) = (f64::from(width), f64::from(height));
    BoxPx::new(b.x1 * w, b.y1 * h, b.x2 * w, b.y2 * h)
}

/// A candidate by centre and size; `None` below the score floor or when a number is not finite.
fn from_centre(label: usize, score: f32, [cx, cy, w, h]: [f32; 4]) -> Option<Candidate> {
    let [cx, cy, w, h] = [cx, cy, w, h].map(f64::from);
    from_corners(
        label,
        score,
        BoxPx::new(cx - w / 2.0, cy - h / 2.0, cx + w / 2.0, cy + h / 2.0),
    )
}

fn from_corners(label: usize, score: f32, b: BoxPx) -> Option<Candidate> {
    let score = f64::from(score);
    (score >= SCORE_FLOOR && b.is_solid()).then_some(Candidate { label, score, b })
}

/// The best label and its score; the first of equals. NaN scores never win.
fn best(scores: &[f32]) -> (usize, f32) {
    let first = (0, f32::NEG_INFINITY);
    scores
        .iter()
        .enumerate()
        .fold(first, |best, (i, s)| if *s > best.1 { (i, *s) } else { best })
}

fn sigmoid(x: f32) -> f32 {
    1.0 / (1.0 + (-x).exp())
}

/// The refusal every head gives when the outputs are not what the manifest says.
fn misfit(kind: &str, expected: String, outputs: &[Tensor]) -> String {
    let found = outputs
        .iter()
        .map(|t| format!("{} {:?}", t.name, t.shape).trim_start().to_owned())
        .collect::<Vec<_>>()
        .join(", ");
    format!("its outputs {found} are not those of a {kind} head ({expected}): the manifest does not fit this file")
}
