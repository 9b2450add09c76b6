//! Photos, poses and detections become numbers: truth boxes, matching, AP, rates, drops.

pub mod cache;
mod caution;
pub mod compare;
pub mod corrupt;
mod criteria;
mod curves;
mod decoded;
mod disagreement;
mod error;
mod evaluated;
pub mod grouping;
mod labelled;
mod observe;
mod outcome;
mod photo;
pub mod preview;
mod protocol;
pub mod protocol_table;
mod ranking;
mod record;
pub mod reliability;
mod robustness;
mod run;
mod scores;
mod sealed;
mod settings;
pub mod shard;
mod side;
mod summary;
mod transfer;
mod worn;

pub use cache::Cache;
pub use compare::{
    ClusteredBy, Compared, Course, Decision, Difference, Expected, Finding, PlanCheck, SEQUENTIAL_ROWS, Sequential,
    SequentialFinding, SequentialPlan, compare_with, most_telling, moved_drops, paired, pairs_needed, places_needed,
    sequential, sequential_plan, smallest_drop_by_place,
};
pub use compare::{CompareError, Comparison, compare};
pub use compare::{power, power_by_place};
pub use corrupt::{Corruption, SEVERITIES};
pub use criteria::Criteria;
pub use curves::{Curves, HitRateFrom, curves};
pub use disagreement::disagreements;
pub use error::ScoreError;
pub use evaluated::{DetectionSource, evaluated_detectors, runtime};
pub use evaluated::{EvaluatedDetector, EvaluatedDetectorError};
pub use grouping::{GroupBy, GroupByError};
pub use labelled::{Averages, LabelledError, LabelledPhotos, feedings};
pub use observe::Options;
pub use observe::{NotScoredReason, libraries};
pub use outcome::{PhotoOutcome, Thresholds, Verdict};
pub use photo::TagMark;
pub use photo::{NotScored, ScoredPhoto};
pub use protocol::Protocol;
pub use protocol_table::{ProtocolTable, protocol_table};
pub use protocol_table::{apricot_ap, rates_as_armory};
pub use ranking::{Ranking, RankingFinding, RankingRow, ranking};
pub use record::{RecordError, check_recordings, record};
pub use reliability::{ConfidenceBin, RELIABILITY_FLOOR, Reliability, reliability};
pub use robustness::{BASE_LOST, CorruptedRow, Robustness, Survival, check_corruptible, under_corruption};
pub use run::score;
pub use run::{TimedPhoto, merge, observe, timed_photos};
pub use scaleproof_core::ap::ApDefinition;
pub use scaleproof_core::ap::{ImageBoxes, average_precision_as};
pub use scaleproof_core::ap::{average_precision, over_ious};
use scores::ScoredSet;
pub use scores::Scores;
pub use sealed::{SealedDetector, SealedPlan, Stopping};
pub use settings::{AppliedSettings, Settings};
pub use summary::{Asr, BinFigures, CellFigures, ConditionFigures, Drop, Figures, Rate, Summary};
pub use transfer::{TransferDrop, TransferRow, transfer};
pub use worn::WornPattern;

/// A detection counts for the model when their boxes overlap by at least this much.
pub const MATCH_IOU: f64 = 0.5;

/// A photo counts as a hit when the matching detection is at least this confident, unless [`Criteria`] say otherwise.
pub const HIT_CONFIDENCE: f64 = 0.5;

/// The variant that drops are measured from.
pub const BASE_VARIANT: &str = "normal";

/// What the words of a comparison mean, stored beside its numbers: (name, definition).
pub fn comparison_definitions() -> impl Iterator<Item = (&'static str, &'static str)> {
    let lines = include_str!("compare/definitions.txt").lines();
    lines.filter_map(|line| line.split_once(" | "))
}
