//! A stored photo set, and the truth boxes that scene and pose give for each photo.
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
