//! Physical validation of adversarial patterns on printed scale models.
//!
//! Print a pattern at 1:10, photograph the model among AprilTags, and score object detectors per viewpoint. The rooms and
//! which may use which are listed in `ARCHITECTURE.md`.

// What only the left-out rooms use is kept: it is small, and a mark on each of its items would be more than it.
#![cfg_attr(not(feature = "full"), allow(dead_code, unused_imports))]

pub mod ap;
#[cfg(feature = "full")]
pub mod attack;
pub mod board;
#[cfg(feature = "full")]
pub mod calibrate;
pub mod camera;
#[cfg(feature = "full")]
pub mod capture;
#[cfg(feature = "full")]
pub mod chart;
pub mod cli;
pub mod colour_chart;
pub mod detect;
pub mod draw;
pub mod envelope;
pub mod files;
pub mod geometry;
mod least_squares;
pub mod locate;
pub mod mesh;
#[cfg(feature = "full")]
pub mod page;
pub mod pattern;
pub mod photo;
pub mod plot;
pub mod print;
pub mod report;
pub mod scene;
pub mod score;
pub mod session;
#[cfg(feature = "full")]
pub mod simulate;
pub mod spelling;
pub mod statistics;
#[cfg(feature = "full")]
pub mod survey;
pub mod tags;
pub mod workers;
