//! Physical validation of adversarial patterns on printed scale models.
//!
//! Print a pattern at 1:10, photograph the model among AprilTags, and score object detectors per viewpoint. The rooms and
//! which may use which are listed in `ARCHITECTURE.md`.
//!
//! # The AprilTag library of a program that depends on this crate
//!
//! `apriltag-sys` links the system's C AprilTag library where `pkg-config` finds one, and the one it carries otherwise. Accuracy is measured
//! with the latter, and an environment variable alone asks for it, which a crate cannot set for those who depend on it. Put it into your
//! own `.cargo/config.toml`:
//!
//! ```toml
//! [env]
//! APRILTAG_SYS_METHOD = "raw,static"
//! ```
//!
//! Either way the provenance of results names the library that is linked.

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
#[cfg(feature = "full")]
pub mod frames;
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
pub mod surrogate;
#[cfg(feature = "full")]
pub mod survey;
pub mod tags;
#[cfg(feature = "full")]
pub mod whitebox;
pub mod workers;
