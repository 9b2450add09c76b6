//! From frames of a model to a pattern (DTA: Suryanto et al., CVPR 2022).
//!
//! - [`run`]: the attack itself;
//! - [`baseline`]: its rivals;
//! - [`setup`]: what both are made on and against;
//! - [`result`]: the files of their results;
//! - [`evaluate`]: patterns rendered on the model, as photos with exact truth.

pub(crate) mod baseline;
pub(crate) mod evaluate;
pub(crate) mod result;
pub(crate) mod run;
pub(crate) mod setup;
