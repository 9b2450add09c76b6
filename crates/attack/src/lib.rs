//! From frames of a model to a pattern (DTA: Suryanto et al., CVPR 2022).
//!
//! - [`run`]: the attack itself;
//! - [`baseline`]: its rivals;
//! - [`setup`]: what both are made on and against;
//! - [`judged`]: patterns on every view of frames;
//! - [`result`]: the files of their results;
//! - [`evaluate`]: patterns rendered on the model, as photos with exact truth.
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

pub mod baseline;
pub mod evaluate;
pub mod judged;
pub mod result;
pub mod run;
pub mod setup;
