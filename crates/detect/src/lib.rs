//! Object detectors: a manifest says how to feed and read an ONNX file; ONNX Runtime runs it.
//!
//! ```
//! use scaleproof_detect::Manifest;
//!
//! let manifest = Manifest::named("yolox_nano")?;
//! assert_eq!(manifest.weights.file, "yolox_nano.onnx");
//! # Ok::<(), scaleproof_detect::ManifestError>(())
//! ```

mod called;
mod choose;
mod coco_results;
mod counting;
mod darknet;
#[cfg(feature = "full")]
pub mod download;
mod foreign;
mod head;
mod heads;
mod input;
mod labels;
mod manifest;
mod nms;
mod onnx;
mod outside;
mod program;
mod propose;
mod runtime;
mod speed;
mod weights;

use serde::{Deserialize, Serialize};

use scaleproof_core::geometry::BoxPx;

pub use called::{CalledDetector, Callee, FoundBox, FoundLabel};
pub use choose::{RegisterError, choose, chosen_as, register, registered, registered_names, unregister};
pub use coco_results::{CocoResult, Recorded, RecordedError, RecordedPhoto, Recording, coco_results};
pub use counting::NoSuchClass;
pub use darknet::{DarknetError, darknet_to_onnx, from_contents as darknet_contents_to_onnx};
pub use foreign::{ForeignCard, ForeignKind};
pub use heads::{Anchor, Anchors, Data, HeadError, Tensor, anchors, candidates, wants_photo_size};
pub use input::{InputPlacement, tensor};
pub use labels::{Labels, LabelsError};
pub use manifest::{
    AnchorHead, AnchorLabels, Channels, EfficientdetHead, FirstLabel, GridAnchors, GridsHead, Head, Input, Kernel,
    Layout, ListHead, Manifest, ManifestError, NetworkFormat, Pad, Resize, Scores, SsdBoxes, SsdHead, StridesHead,
    TableHead, Unit, Values, Weights,
};
pub use nms::{BestFirst, CandidateBox, suppress};
pub use onnx::model as onnx_model;
pub use outside::{OutsideError, OutsideResults, PhotoName, PhotoNames, ResultsRequest, flat_name};
pub use program::{
    Gradients, ProgramDefence, ProgramDetector, ProgramError, ProgramImage, ProgramPhoto, ProgramSpec,
    ProgramSpecError, keep_programs_in_our_group, kill_programs, protocol,
};
pub use propose::{
    Family, Hints, Proposal, ProposalNote, ProposeError, height_and_width, own_name, preprocessed, propose,
    python_names, weights_seen_from,
};
pub use runtime::{DetectError, Detector, Runtime};
pub use speed::{Speed, SpeedError, Speeds};
pub use weights::{WeightFolders, WeightsError};

/// Candidates below this score are dropped; AP needs them down to here.
pub const SCORE_FLOOR: f64 = 0.001;

/// So many candidates are kept per photo, the best first: what COCO's evaluation looks at.
pub const MAX_DETECTIONS: usize = 100;

/// A sigmoid or softmax may round up a little. What it rounded up is kept as 1, the highest score that files may have.
const HIGHEST_SCORE: f64 = 1.001;

/// One box a detector found.
///
/// Coordinates are rounded to 0.01 px and scores to 1e-6, so that a run and its recording are the same numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Detection {
    /// Index into the detector's labels.
    pub label: usize,
    /// Confidence, 0 to 1.
    pub score: f64,
    /// In pixels of the photo.
    pub box_px: BoxPx,
}

impl Detection {
    /// A detection in the precision that files keep; `None` when the numbers are not finite or the box is empty.
    pub fn new(label: usize, score: f64, b: BoxPx) -> Option<Detection> {
        let hundredth = |v: f64| (v * 100.0).round() / 100.0;
        let (x1, y1) = (hundredth(b.x1), hundredth(b.y1));
        // Width and height are what COCO files keep, so they are rounded, and the far corner follows from them.
        let (x2, y2) = (
            hundredth(x1 + hundredth(b.x2 - b.x1)),
            hundredth(y1 + hundredth(b.y2 - b.y1)),
        );
        let box_px = BoxPx::new(x1, y1, x2, y2);
        let score = (score * 1e6).round() / 1e6;
        (score.is_finite() && box_px.is_solid()).then_some(Detection { label, score, box_px })
    }

    /// `[x, y, width, height]` in hundredths of a pixel.
    pub fn to_xywh(&self) -> [f64; 4] {
        self.box_px.to_xywh().map(|v| (v * 100.0).round() / 100.0)
    }
}
