//! Unit and property tests of scoring and its reports.

use scaleproof_testing as common;

#[path = "score/average_precision.rs"]
mod average_precision;
#[path = "score/cache.rs"]
mod cache;
#[path = "score/compare.rs"]
mod compare;
#[path = "score/contradicted.rs"]
mod contradicted;
#[path = "score/corrupt.rs"]
mod corrupt;
#[path = "score/findings.rs"]
mod findings;
#[path = "score/grouping.rs"]
mod grouping;
#[path = "score/latex.rs"]
mod latex;
#[path = "score/numbers.rs"]
mod numbers;
#[path = "score/outcome.rs"]
mod outcome;
#[path = "score/plan.rs"]
mod plan;
#[path = "score/polar.rs"]
mod polar;
#[path = "score/preview.rs"]
mod preview;
#[path = "score/protocol_table.rs"]
mod protocol_table;
#[path = "score/reliability.rs"]
mod reliability;
#[path = "score/shade.rs"]
mod shade;
#[path = "score/shard.rs"]
mod shard;
#[path = "score/table.rs"]
mod table;
