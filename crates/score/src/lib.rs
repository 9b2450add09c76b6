//! Scoring of photo sets: matching, average precision, hit rates, comparisons with intervals, and the report.
//!
//! ```
//! use std::path::Path;
//! use scaleproof_detect::Manifest;
//! use scaleproof_score::report::summary_table;
//! use scaleproof_score::score::{EvaluatedDetector, Options, score};
//! use scaleproof_session::session::Session;
//!
//! // With the detections that were recorded with the stored photos.
//! let session = Session::open(Path::new("../../captures/skyline"))?;
//! let class = &session.scene.model.class;
//! let detector = EvaluatedDetector::recorded(Manifest::named("yolox_nano")?, &[&session.folder], class)?;
//! let scores = score(vec![session], vec![detector], &Options::default(), || ())?;
//! println!("{}", summary_table(&scores));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod report;
pub mod score;
