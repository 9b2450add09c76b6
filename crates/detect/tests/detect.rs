//! The crate's own tests; what the program shows of it is tested by the program's.

use scaleproof_testing as common;

#[path = "detect/counting.rs"]
mod counting;
#[path = "detect/darknet.rs"]
mod darknet;
#[path = "detect/detection.rs"]
mod detection;
#[path = "detect/detector_heads.rs"]
mod detector_heads;
#[path = "detect/download.rs"]
mod download;
#[path = "detect/exported.rs"]
mod exported;
#[path = "detect/heads.rs"]
mod heads;
#[path = "detect/input.rs"]
mod input;
#[path = "detect/labels.rs"]
mod labels;
#[path = "detect/linear.rs"]
mod linear;
#[path = "detect/manifest.rs"]
mod manifest;
#[path = "detect/metadata.rs"]
mod metadata;
#[path = "detect/nms.rs"]
mod nms;
#[path = "detect/onnx_model.rs"]
mod onnx_model;
#[path = "detect/others.rs"]
mod others;
#[path = "detect/photo_names.rs"]
mod photo_names;
#[path = "detect/protocol.rs"]
mod protocol;
#[path = "detect/spec.rs"]
mod spec;
#[path = "detect/weights.rs"]
mod weights;
