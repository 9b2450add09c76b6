//! Physical validation of adversarial patterns on printed scale models: print a pattern at 1:10, photograph the model among AprilTags, and
//! score object detectors per viewpoint.
//!
//! ```no_run
#![doc = include_str!("../examples/locate_a_photo.rs")]
//! ```
//!
//! `examples/` also scores a session and prints a template. Everything the program `scaleproof` does goes through this library; what is
//! public here is what other programs need. Lengths are millimetres, angles degrees; the model frame has x to the front, y to the left and z up,
//! with its origin on the ground below the model, and the camera frame is OpenCV's.
//!
//! # Building
//! Scoring needs ONNX Runtime at run time (`ORT_DYLIB_PATH` names its shared library). The feature `full` (default) needs OpenCV 4 and clang; without it
//! photos are located and scored, and patterns are printed. The feature `attack` adds the tensor framework. ARCHITECTURE.md lists the rooms.
//!
//! `apriltag-sys` links the system's C AprilTag library where `pkg-config` finds one. Accuracy is measured with the one it carries, for which a
//! program that depends on this crate asks in its own `.cargo/config.toml`; the provenance of results names the library either way:
//!
//! ```toml
//! [env]
//! APRILTAG_SYS_METHOD = "raw,static"
//! ```

#![deny(missing_docs)]
#![cfg_attr(all(feature = "attack", not(any(test, fuzzing))), deny(unreachable_pub))]
// What only the left-out rooms use is kept: it is small, and a mark on each of its items would be more than it.
#![cfg_attr(not(all(feature = "full", feature = "attack")), allow(dead_code, unused_imports))]

#[cfg(feature = "full")]
mod advise;
mod ap;
#[cfg(feature = "full")]
mod attack;
#[cfg(feature = "full")]
mod bake;
mod board;
#[cfg(feature = "full")]
mod calibrate;
mod camera;
#[cfg(feature = "full")]
mod capture;
#[cfg(feature = "full")]
mod chart;
mod cli;
mod colour_chart;
mod detect;
mod draw;
mod envelope;
mod files;
#[cfg(feature = "full")]
mod frames;
mod geometry;
mod least_squares;
mod locate;
mod mesh;
#[cfg(feature = "full")]
mod page;
mod pattern;
mod photo;
mod plot;
mod print;
mod report;
mod scene;
mod score;
mod session;
#[cfg(feature = "full")]
mod simulate;
mod spelling;
mod statistics;
#[cfg(feature = "full")]
mod surrogate;
#[cfg(feature = "full")]
mod survey;
mod tags;
mod texture;
mod unwrap;
#[cfg(feature = "full")]
mod whitebox;
mod workers;

pub use camera::{Camera, CameraError, CameraFormat, FittedCamera, SizeError};
pub use detect::{DetectError, Detection, Manifest, ManifestError, Speeds, WeightFolders, WeightsError};
pub use files::FileError;
pub use geometry::{BoxPx, Rigid};
pub use locate::{Abstention, Located, LocatedPhoto, Sigma, Warning, locate, locate_photo};
pub use pattern::{Pattern, PatternError};
pub use photo::{Luma, Photo, PhotoError};
pub use print::SheetError;
pub use print::paper::{Orientation, Paper, Stock};
pub use print::pdf::write as write_pdf;
pub use print::printer::Printer;
pub use print::template::{Front, LayoutRequest, Template, TemplateError, TemplateRequest, template};
pub use report::{ReportError, summary_table, write as write_report};
pub use scene::{Bin, Bins, Classes, Envelope, ScaleModel, Scene, Tag, TagFamily, Viewpoint};
pub use score::{
    ApDefinition, Cache, CompareError, Comparison, Criteria, EvaluatedDetector, EvaluatedDetectorError, NotScored,
    Options, Protocol, ScoreError, ScoredPhoto, Scores, compare, score,
};
pub use session::{Conditions, PhotoEntry, Session, SessionError};
pub use tags::{CornersBy, ExpectedTag, SeenTag, StartError, StillMissing, TagDetector, TagDetectorChoice};

#[cfg(feature = "attack")]
pub use attack::run::augmentation::Eot;
#[cfg(feature = "attack")]
pub use attack::run::view_set::{TextureMapping, ViewSet};
#[cfg(feature = "attack")]
pub use attack::run::{Attack, AttackConfig, CellColours, RunError};
#[cfg(feature = "attack")]
pub use burn::tensor::Device as TensorDevice;
#[cfg(feature = "full")]
pub use frames::{FrameSet, FramesError};
#[cfg(feature = "attack")]
pub use surrogate::projection::Grid;
#[cfg(feature = "attack")]
pub use whitebox::{Boxes, WhiteBox, WhiteBoxError, detector::OnnxDetector};

/// The program `scaleproof`.
#[doc(hidden)]
pub fn main() -> std::process::ExitCode {
    cli::main()
}

/// What fuzzing and the tests call.
#[cfg(any(test, fuzzing))]
#[doc(hidden)]
#[path = "../fuzz/entry.rs"]
pub mod fuzz_entry;
// The tests of whole rooms see what is not public, under the name that programs use.
#[cfg(any(test, fuzzing))]
extern crate self as scaleproof;
#[cfg(test)]
#[path = "../tests/mod.rs"]
mod tests;
