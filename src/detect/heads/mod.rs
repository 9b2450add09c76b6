//! One file per output layout: tensors in, candidates out.

mod deim;
mod fastestdet;
mod nanodet;
mod yolox;

use super::SCORE_FLOOR;
use super::manifest::{Head, Manifest};
use super::nms::{self, Candidate};
use crate::geometry::BoxPx;

/// One output tensor, row-major.
#[derive(Debug, Clone)]
pub(super) struct Tensor {
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
}

/// Candidates in input pixels for most heads; DEIM answers in photo pixels.
pub(super) struct Decoded {
    pub candidates: Vec<Candidate>,
    pub in_photo_px: bool,
}

/// Reads a detector's outputs.
pub(super) fn decode(manifest: &Manifest, outputs: &[Tensor]) -> Result<Decoded, String> {
    let labels = manifest.labels.count();
    let size = manifest.input.size_px;
    let suppressed = |candidates: Vec<Candidate>, iou: f64| Decoded {
        candidates: nms::suppress(candidates, iou),
        in_photo_px: false,
    };
    match &manifest.head {
        Head::Yolox { nms_iou } => Ok(suppressed(yolox::decode(outputs, size, labels)?, *nms_iou)),
        Head::Nanodet { strides, nms_iou } => {
            Ok(suppressed(nanodet::decode(outputs, size, strides, labels)?, *nms_iou))
        }
        Head::Fastestdet { nms_iou } => Ok(suppressed(fastestdet::decode(outputs, size, labels)?, *nms_iou)),
        Head::Deim {} => Ok(Decoded {
            candidates: deim::decode(outputs, labels)?,
            in_photo_px: true,
        }),
    }
}

/// Does the detector want the photo's size as a second input?
pub(super) fn wants_photo_size(head: &Head) -> bool {
    matches!(head, Head::Deim {})
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
        .map(|t| format!("{:?}", t.shape))
        .collect::<Vec<_>>()
        .join(", ");
    format!("its outputs {found} are not those of a {kind} head ({expected}): the manifest does not fit this file")
}
