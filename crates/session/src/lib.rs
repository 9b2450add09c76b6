//! Stored photo sets, and the ground truth boxes of their photos by scene and pose ([`envelope`]).
//!
//! A session is a folder with `session.json`, which names the photos, the scene and the camera; or it is made of folders of photos as they are.
//!
//! ```
//! use std::path::Path;
//! use scaleproof_session::Session;
//!
//! let session = Session::open(Path::new("../../captures/skyline"))?;
//! assert_eq!(session.photos.len(), 24);
//! # Ok::<(), scaleproof_session::SessionError>(())
//! ```

pub mod conditions; // names and values by which photos are grouped
pub mod contents; // a session in short, for people and programs
pub mod envelope; // ground truth box of a photo: the model's envelope, projected
mod error; // reasons why there is no session
pub mod filling; // lock of a session that a run fills
pub mod folders; // sessions of folders of photos, in memory
pub mod import; // sessions of COCO annotations or a table
mod list; // session.json: its photos, and the checks of them
pub mod new; // sessions written to disk
mod opened; // a session and the files it names, opened
pub mod overlay; // copies of photos with tags, pose and boxes drawn in

pub use conditions::Conditions;
pub use error::SessionError;
pub use list::{PhotoEntry, VideoFrame};
pub use new::{NewSession, files_below};
pub use opened::{Session, text};
