//! Tests of the crate by its public names, linked once.

use scaleproof_testing as common;

#[path = "wrap/unwrap.rs"]
mod unwrap;
