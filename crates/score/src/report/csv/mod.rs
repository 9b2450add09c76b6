//! Files for spreadsheets.

pub mod comparison; // comparison.csv
pub mod evaluation; // evaluation.csv and differences.csv
pub mod figures; // figures.csv
pub mod photos; // photos.csv
pub mod robustness; // robustness.csv and defences.csv
pub mod rows; // rows of named values
