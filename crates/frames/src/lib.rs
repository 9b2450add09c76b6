//! Images of the model whose truth is known, and surrogate renderers that predict them in any paint.
//!
//! ```
//! use std::path::Path;
//! use scaleproof_frames::frames::{FrameSet, views};
//!
//! let set = FrameSet::open(Path::new("../../captures/skyline_frames"))?;
//! assert!(views(&set.list.frames).len() < set.list.frames.len(), "each view in several paints");
//! # Ok::<(), scaleproof_frames::frames::FramesError>(())
//! ```

pub mod frames;
pub mod surrogate;
