//! Plain tools that know nothing of photos or models: geometry, statistics, average precision, least squares, files, workers, errors.
//!
//! ```
//! use scaleproof_core::statistics::{holm, mcnemar_p};
//!
//! // Of ten pairs of photos six differ, all in one direction; another detector shows nothing.
//! let p = mcnemar_p(&[1, 1, 1, 1, 1, 1, 0, 0, 0, 0]);
//! assert!((p - 0.03125).abs() < 1e-12);
//! assert_eq!(holm(&[p, 0.5]), [0.0625, 0.5]);
//! ```

pub mod ap; // average precision in four definitions
pub mod coco; // files of boxes in COCO's format
pub mod files; // files read with limits and written whole or not at all
pub mod geometry; // lengths, angles, boxes, rigid transformations, homographies
pub mod least_squares; // the Levenberg-Marquardt loop
pub mod message; // errors that nobody tells apart, and hints
pub mod spelling; // names quoted, listed and guessed
pub mod statistics; // intervals and tests
mod vectors; // rows of numbers, several at once
pub mod workers; // threads, interruption, memory

/// DejaVu Sans, Latin-1: the letters of sheets and of labels in images.
pub const FONT: &[u8] = include_bytes!("../fonts/DejaVuSans-latin1.ttf");
