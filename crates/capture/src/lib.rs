//! Guided capture: frames in, advice out, and a session that holds one good photo of each required view; and its [`page`] in a browser.
//!
//! A frame goes through `gates` (tags, pose, focus, light, steadiness) and `guidance` (the nearest view still required); one that
//! passes is stored at once (`store`), and a refused frame gets one sentence of `advice`. No clock is read: photos are ordered by their
//! numbers.
//!
//! ```
//! use scaleproof_capture::{Guidance, Tolerance};
//! use scaleproof_pose::scene::Bins;
//!
//! // Once round the model at 45° steps.
//! let bins = Bins { azimuth_deg: 45.0, pitch_deg: vec![15.0], distance_mm: vec![900.0] };
//! let views = bins.viewpoints(&bins.pitch_deg, &bins.distance_mm);
//! let guidance = Guidance::at(&views, Tolerance::of_bins(&bins, &bins.distance_mm), &bins);
//! assert_eq!(guidance.targets().len(), 8);
//! assert!(!guidance.is_finished());
//! ```

mod advice; // the one sentence about a frame that is not taken
mod answer; // what became of a frame
mod capture; // frames judged, and accepted into the session
mod gates; // what must hold of a frame: tags, pose, focus, light, steadiness
mod guidance; // views that are required, and the step to the next
mod guided; // a capture from its request to its end
mod interruptible; // sources that can be given up while they wait
pub mod page; // the capture in a browser
pub mod pair; // another session's viewpoints as required views
mod recover; // what an interrupted capture left, finished
mod source; // where frames come from
mod steady; // frames in a row that are fit for the same target
mod store; // the session that is filled

pub use advice::Advice;
pub use answer::{FrameAnswer, FrameLine};
pub use capture::Capture;
pub use gates::{FrameJudgement, Judge, MAX_BLUR_PX, MAX_CLIPPED, MAX_MOVED_PX, MAX_WHITE, MIN_WHITE, Measures};
pub use guidance::{BinName, Guidance, NextMove, Target, Tolerance};
pub use guided::{
    CaptureEnd, GuidedCapture, GuidedError, GuidedRequest, OpenedCapture, PageRequest, SourceOptions, ViewsRequest,
};
pub use interruptible::OnInterrupt;
pub use source::{
    CameraSettings, FrameSource, LiveCamera, Original, Replay, SourceError, SourceFrame, SourceName, Watch,
    interrupt_programs, live, stream,
};
pub use store::{Sidecar, Store, StoreError, sidecar_of, slug};
