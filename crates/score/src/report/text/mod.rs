//! Reports for the terminal.

pub mod comparison; // a comparison
pub mod evaluation; // an evaluation of patterns
pub mod run; // a scoring run
pub mod screen; // a table as wide as a screen
