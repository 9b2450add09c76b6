//! Calibration boards: the file that describes one, and where its corners are, for printing and detection.

mod corners;
mod definition;

pub use corners::Marker;

pub use definition::Definition;
