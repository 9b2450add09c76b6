//! Object detectors: a manifest says how to feed and read an ONNX file; ONNX Runtime runs it.
//!
//! ```
//! use scaleproof_detect::Manifest;
//!
//! let manifest = Manifest::named("yolox_nano")?;
//! assert_eq!(manifest.weights.file, "yolox_nano.onnx");
//! # Ok::<(), scaleproof_detect::ManifestError>(())
//! ```

mod called; // functions of the process that find objects
mod choose; // detectors by name, and those that a user registered
mod coco_results; // COCO results, and recordings of detections
mod counting; // labels that count as the model
mod darknet; // Darknet's networks as ONNX files
mod detection; // one box that a detector found
#[cfg(feature = "full")]
pub mod download; // weights fetched and verified
mod foreign; // detectors that another program runs
mod head; // output heads as a manifest states them
mod heads; // output tensors to candidate boxes, one file a form
mod input; // photos to input tensors, and boxes back
mod labels; // lists of class names
mod manifest; // manifests: files that describe a detector
mod nms; // non-maximum suppression
mod onnx; // ONNX files as nodes and constants
mod outside; // detections in files of other programs
mod program; // programs as detectors, over pipes
mod propose; // manifests proposed for ONNX files
mod runtime; // ONNX Runtime and its sessions
mod speed; // times a photo takes
mod weights; // weight files found and verified

pub use called::{CalledDetector, Callee, FoundBox, FoundLabel};
pub use choose::{RegisterError, choose, chosen_as, register, registered, registered_names, unregister};
pub use coco_results::{CocoResult, Recorded, RecordedError, RecordedPhoto, Recording, coco_results};
pub use counting::NoSuchClass;
pub use darknet::{darknet_to_onnx, from_contents as darknet_contents_to_onnx};
pub(crate) use detection::HIGHEST_SCORE;
pub use detection::{Detection, MAX_DETECTIONS, SCORE_FLOOR};
pub use foreign::{ForeignCard, ForeignKind};
pub use heads::{Anchor, Anchors, Data, HeadError, Tensor, anchors, candidates, wants_photo_size};
pub use input::{InputPlacement, tensor};
pub use labels::Labels;
pub use manifest::{
    AnchorHead, AnchorLabels, Channels, EfficientdetHead, FirstLabel, GridAnchors, GridsHead, Head, Input, Kernel,
    Layout, ListHead, Manifest, ManifestError, Pad, Resize, Scores, SsdBoxes, SsdHead, StridesHead, TableHead, Unit,
    Values, Weights,
};
pub use nms::{BestFirst, CandidateBox, suppress};
pub use onnx::model as onnx_model;
pub use outside::{OutsideError, OutsideResults, PhotoName, PhotoNames, ResultsRequest, flat_name};
pub use program::{
    Gradients, ProgramDefence, ProgramDetector, ProgramError, ProgramImage, ProgramPhoto, ProgramSpec,
    keep_programs_in_our_group, kill_programs, protocol,
};
pub use propose::{
    Family, Hints, Proposal, ProposeError, height_and_width, own_name, preprocessed, propose, python_names,
    weights_seen_from,
};
pub use runtime::{DetectError, Detector, Runtime};
pub use speed::{Speed, Speeds};
pub use weights::{WeightFolders, WeightsError};
