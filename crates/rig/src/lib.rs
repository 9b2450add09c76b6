//! Measurements made once for a set-up: camera calibration from photos of a board, and a survey of tags placed by hand.
//!
//! ```
//! use std::path::Path;
//! use scaleproof_pose::board::Definition;
//! use scaleproof_rig::calibrate;
//!
//! let board = Definition::open(Path::new("../../calibration/charuco_9x7_22mm.toml"))?;
//! let photo = Path::new("../../captures/skyline/normal_000.jpg").to_owned();
//! let (seen, unused) = calibrate::detect_boards(&[photo], &board, || ());
//! assert!(seen.is_empty() && unused.len() == 1, "the photo of the model shows no board");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod calibrate; // a camera from photos or a film of a board, or of a scene's tags
pub mod survey; // places of tags from photos
