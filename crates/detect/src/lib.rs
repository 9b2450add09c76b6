//! Object detectors: a manifest says how to feed and read an ONNX file; ONNX Runtime runs it.
//!
//! ```
//! use scaleproof_detect::Manifest;
//!
//! let manifest = Manifest::named("yolox_nano")?;
//! assert_eq!(manifest.weights.file, "yolox_nano.onnx");
//! # Ok::<(), scaleproof_detect::ManifestError>(())
//! ```

mod choose;
mod coco_results;
mod counting;
#[cfg(feature = "full")]
mod fetch;
mod foreign;
mod heads;
mod input;
mod labels;
mod linear;
mod manifest;
mod nms;
mod outside;
mod program;
mod propose;
mod registered;
mod runtime;
mod speed;
mod weights;

use serde::{Deserialize, Serialize};

use scaleproof_core::geometry::BoxPx;

pub use choose::{choose, chosen_as};
pub use coco_results::{Recorded, RecordedError, RecordedPhoto, Recording, coco_results};
pub use counting::NoSuchClass;
#[cfg(feature = "full")]
pub use fetch::{FetchError, fetch};
pub use foreign::{ForeignCard, ForeignKind};
pub use heads::wants_photo_size;
pub use heads::{Anchor, Anchors, Data, Tensor, anchors};
pub use input::InputPlacement;
pub use input::tensor;
pub use labels::{Labels, LabelsError};
pub use manifest::{Channels, Kernel, Resize};
pub use manifest::{Input, Layout, Values};
pub use manifest::{Manifest, ManifestError};
pub use nms::{CandidateBox, suppress};
pub use outside::{OutsideError, OutsideResults, PhotoName, ResultsRequest, flat_name};
pub use program::read_as_a_programs;
pub use program::{
    Gradients, ProgramDetector, ProgramError, ProgramImage, ProgramPhoto, ProgramSpec, ProgramSpecError, kill_programs,
};
pub use propose::Proposal;
pub use propose::propose_within;
pub use propose::{Family, Hints, ProposalNote, ProposeError, propose};
pub use registered::{RegisterError, register, registered, registered_names, unregister};
pub use runtime::DetectError;
pub use runtime::{Detector, Runtime};
pub use speed::Speeds;
pub use speed::{Speed, SpeedError};
pub use weights::{WeightFolders, WeightsError};

/// Candidates below this score are dropped; AP needs them down to here.
pub const SCORE_FLOOR: f64 = 0.001;

/// So many candidates are kept per photo, the best first: what COCO's evaluation looks at.
pub const MAX_DETECTIONS: usize = 100;

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
    fn to_xywh(&self) -> [f64; 4] {
        self.box_px.to_xywh().map(|v| (v * 100.0).round() / 100.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// A detection written as COCO writes it and read again is the same detection, bit for bit.
        #[test]
        fn detections_survive_a_file(x in -50.0..4000.0_f64, y in -50.0..3000.0_f64, w in 0.1..4000.0_f64, h in 0.1..3000.0_f64, s in 0.0..1.0_f64) {
            let d = Detection::new(2, s, BoxPx::new(x, y, x + w, y + h)).unwrap();
            let [x, y, w, h] = d.to_xywh();
            prop_assert_eq!(Detection::new(2, d.score, BoxPx::new(x, y, x + w, y + h)).unwrap(), d);
        }
    }
}
