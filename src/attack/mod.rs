//! From frames of a model to a pattern (DTA: Suryanto et al., CVPR 2022).
//!
//! - [`run`]: the attack itself;
//! - [`baseline`]: its rivals;
//! - [`evaluate`]: patterns rendered anew on the model, as photos with exact truth.

pub mod baseline;
pub mod evaluate;
pub mod run;
