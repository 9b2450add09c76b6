//! Plain tools that know nothing of photos or models: geometry, statistics, average precision, least squares, files, workers.
//!
//! ```
//! use scaleproof_core::statistics::{holm, mcnemar_p};
//!
//! // Of ten pairs of photos six differ, all in one direction; another detector shows nothing.
//! let p = mcnemar_p(&[1, 1, 1, 1, 1, 1, 0, 0, 0, 0]);
//! assert!((p - 0.03125).abs() < 1e-12);
//! assert_eq!(holm(&[p, 0.5]), [0.0625, 0.5]);
//! ```

pub mod ap;
pub mod coco;
pub mod files;
pub mod geometry;
pub mod least_squares;
pub mod spelling;
pub mod statistics;
mod vectors;
pub mod workers;

/// DejaVu Sans, Latin-1: the letters of sheets and of labels in images.
pub const FONT: &[u8] = include_bytes!("../fonts/DejaVuSans-latin1.ttf");
