//! Files for spreadsheets.

pub mod comparison; // comparison.csv
pub mod defences; // defences.csv
pub mod evaluation; // evaluation.csv and differences.csv
pub mod figures; // figures.csv
pub mod paired_columns; // columns of a comparison
pub mod photos; // photos.csv
pub mod robustness; // robustness.csv
pub mod rows; // rows of named values
