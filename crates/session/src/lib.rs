//! Stored photo sets, and the ground truth boxes of their photos by scene and pose.
//!
//! ```
//! use std::path::Path;
//! use scaleproof_session::session::Session;
//!
//! let session = Session::open(Path::new("../../captures/skyline"))?;
//! assert_eq!(session.photos.len(), 24);
//! # Ok::<(), scaleproof_session::session::SessionError>(())
//! ```

pub mod envelope;
pub mod overlay;
pub mod session;
