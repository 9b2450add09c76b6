//! Physical validation of adversarial patterns on printed scale models.
//!
//! Print a pattern at 1:10, photograph the model among AprilTags, and score object detectors per viewpoint. The rooms and
//! which may use which are listed in `ARCHITECTURE.md`.

pub mod ap;
pub mod attack;
pub mod board;
pub mod calibrate;
pub mod camera;
pub mod capture;
pub mod chart;
pub mod cli;
pub mod colour_chart;
pub mod detect;
pub mod draw;
pub mod envelope;
pub mod files;
pub mod geometry;
pub mod locate;
pub mod mesh;
pub mod page;
pub mod pattern;
pub mod photo;
pub mod plot;
pub mod print;
pub mod report;
pub mod scene;
pub mod score;
pub mod session;
pub mod simulate;
pub mod statistics;
pub mod survey;
pub mod tags;
pub mod workers;
