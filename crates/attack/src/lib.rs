//! From frames of a model to a pattern (DTA: Suryanto et al., CVPR 2022).
//!
//! ```
//! use scaleproof_attack::run::batch;
//!
//! // A run that goes on after a stop draws the views that one without a stop draws.
//! let views: Vec<usize> = (0..12).collect();
//! assert_eq!(batch(&views, 4, 7, 2), batch(&views, 4, 7, 2));
//! let mut first_three: Vec<usize> = (0..3).flat_map(|step| batch(&views, 4, 7, step)).collect();
//! first_three.sort();
//! assert_eq!(first_three, views, "every view comes once before any comes again");
//! ```

pub mod baseline; // its rivals: patterns found without gradients, patches
mod error; // the error of the crate
pub mod evaluate; // patterns rendered on the model, as photos with exact truth
pub mod judged; // patterns judged on every view of frames
pub mod result; // the files of a result
pub mod run; // the attack itself
pub mod setup; // the frames, views and detectors of both

pub use error::AttackError;
