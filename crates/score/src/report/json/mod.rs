//! Files for programs.

pub mod coco; // COCO annotation files
pub mod comparison; // comparison.json
pub mod summary; // summary.json
