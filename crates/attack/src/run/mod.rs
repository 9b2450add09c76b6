//! The attack (DTA, CVPR 2022, algorithm 1): a pattern's cells are moved against the confidence of detectors, through
//! the texture projection, the surrogate renderer and the augmentation.

pub mod adam; // Adam's moments of cells
mod attack; // the attack: its steps
pub mod augmentation; // random changes between the pattern and the detector
mod cells; // cells as sRGB, from and to images
pub mod checkpoint; // the file that a resumed run goes on from
mod config; // the settings
pub mod difficulty; // the choice of a step's views
mod draw; // random numbers and views of a step
pub mod history; // the course of a run, and charts
pub mod judge; // detections of a pattern in the views held out
pub mod loss; // the attack loss
mod parallel; // images looked at in parallel
pub mod penalty; // smoothness, and the distance to another pattern
pub mod printer; // the colours that a printer makes of the cells
pub mod resample; // images resized and moved
pub mod view_set; // the views, each with its surrogate renderer and texture projection
pub mod weights; // the weight of each of several detectors

pub use attack::{Attack, AttackState, LossAndGradient, loss_and_gradient};
pub use cells::{Rgb, of_image, of_pattern, srgb, to_image};
pub use config::{AttackConfig, CellColours, Near};
pub use draw::{batch, drawn_by};
