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
//! photos are located and scored, and patterns are printed. ARCHITECTURE.md shows the crates below.
//!
//! `apriltag-sys` links the system's C AprilTag library where `pkg-config` finds one. Accuracy is measured with the one it carries, for which a
//! program that depends on this crate asks in its own `.cargo/config.toml`; the provenance of results names the library either way:
//!
//! ```toml
//! [env]
//! APRILTAG_SYS_METHOD = "raw,static"
//! HOST_CFLAGS = "-std=gnu17" # for GCC 15 and later
//! ```

#![deny(missing_docs)]
#[macro_use]
extern crate scaleproof_terminal;

mod cli;

pub use scaleproof_core::files::FileError;
pub use scaleproof_core::geometry::{BoxPx, Rigid};
pub use scaleproof_detect::{DetectError, Detection, Manifest, ManifestError, Speeds, WeightFolders, WeightsError};
pub use scaleproof_photo::{Luma, Photo, PhotoError};
pub use scaleproof_pose::camera::{Camera, CameraError, CameraFormat, FittedCamera, SizeError};
pub use scaleproof_pose::locate::{Abstention, Located, LocatedPhoto, Sigma, Warning, locate, locate_photo};
pub use scaleproof_pose::scene::{Bin, Bins, Classes, Envelope, ScaleModel, Scene, Tag, TagFamily, Viewpoint};
pub use scaleproof_pose::tags::{
    CornersBy, ExpectedTag, SeenTag, StartError, StillMissing, TagDetector, TagDetectorChoice,
};
pub use scaleproof_print::SheetError;
pub use scaleproof_print::media::Media;
pub use scaleproof_print::paper::{Orientation, Paper, Stock};
pub use scaleproof_print::pdf::write as write_pdf;
pub use scaleproof_print::printer::Printer;
pub use scaleproof_print::template::{Front, LayoutRequest, Template, TemplateError, TemplateRequest, template};
pub use scaleproof_score::report::{ReportError, summary_table, write as write_report};
pub use scaleproof_score::{
    ApDefinition, Cache, CompareError, Comparison, Criteria, EvaluatedDetector, EvaluatedDetectorError, NotScored,
    Options, Protocol, ScoreError, ScoredPhoto, Scores, compare, score,
};
pub use scaleproof_session::{Conditions, PhotoEntry, Session, SessionError};
pub use scaleproof_surface::pattern::{Pattern, PatternError};

#[cfg(feature = "full")]
pub use {
    scaleproof_attack::AttackError,
    scaleproof_attack::run::augmentation::Eot,
    scaleproof_attack::run::view_set::{TextureMapping, ViewSet},
    scaleproof_attack::run::{Attack, AttackConfig, CellColours},
    scaleproof_frames::surrogate::projection::Grid,
    scaleproof_frames::{FrameSet, FramesError},
    scaleproof_gradients::{Boxes, WhiteBox, WhiteBoxError, detector::OnnxDetector},
};

/// The program `scaleproof`: its exit code, given its arguments with its own name first.
#[doc(hidden)]
pub fn main(arguments: &[std::ffi::OsString]) -> u8 {
    cli::main(arguments)
}

/// Functions of the program that the Python module calls.
#[doc(hidden)]
pub use cli::in_process;
