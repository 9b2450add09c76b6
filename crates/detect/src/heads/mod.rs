//! Output tensors in, candidate boxes out, by the form in which networks answer: tables, grids, distances, lists, or boxes of their own choice.

mod anchor;
mod distances;
pub(super) mod efficientdet;
mod error;
mod grids;
mod listed;
mod queries;
pub(super) mod ssd;
mod tables;
mod tensor;

pub use anchor::{Anchor, Anchors};
pub(super) use distances::BINS;
pub use error::HeadError;
use listed::Rows;
pub(super) use listed::TENSORFLOW;
pub(super) use ssd::{Pair, has_room};
pub use tensor::{Data, Tensor};

use super::manifest::{Head, Manifest};
use super::nms::CandidateBox;
use anchor::{is_finite, scaled};
use scaleproof_core::geometry::BoxPx;
use scaleproof_core::message::Message;

/// The anchors of a detector's outputs for an input of width × height `size` in pixels; `None` for heads that choose their boxes by
/// themselves.
pub fn anchors(manifest: &Manifest, outputs: &[Tensor], size: [u32; 2]) -> Result<Option<Anchors>, Message> {
    let labels = manifest.labels.count();
    let found = match &manifest.head {
        Head::Yolox(_) => tables::yolox(outputs, size, labels)?,
        Head::Nanodet(head) => {
            distances::by_stride("nanodet", outputs, size, &head.strides, labels, distances::NANODET)?
        }
        Head::Picodet(head) => {
            distances::by_stride("picodet", outputs, size, &head.strides, labels, distances::PICODET)?
        }
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
fn deim(outputs: &[Tensor]) -> Result<Rows<'_>, Message> {
    Rows::pick(outputs, "deim", "labels 1×n, boxes 1×n×4, scores 1×n")
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
    let corners = <[f64; 4]>::from(c.b);
    Err(HeadError::NotFinite(format!(
        "a box that is not finite ({corners:?}){place}"
    )))
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

/// Does the detector want the photo's size as a second input?
pub fn wants_photo_size(head: &Head) -> bool {
    matches!(head, Head::Deim {})
}
