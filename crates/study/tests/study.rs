//! Tests of the crate by its public names, linked once.

use scaleproof_testing as common;

#[path = "study/advise_regret.rs"]
mod advise_regret;
#[path = "study/photo_doubt.rs"]
mod photo_doubt;
#[path = "study/pose_doubt.rs"]
mod pose_doubt;
#[path = "study/sigma.rs"]
mod sigma;
