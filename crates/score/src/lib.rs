//! Figures from photos, poses and detections: matching, average precision, hit rates, comparisons with intervals, and the [`report`].
//!
//! ```
//! use std::path::Path;
//! use scaleproof_detect::Manifest;
//! use scaleproof_score::report::summary_table;
//! use scaleproof_score::{EvaluatedDetector, Options, score};
//! use scaleproof_session::Session;
//!
//! // With the detections that were recorded with the stored photos.
//! let session = Session::open(Path::new("../../captures/skyline"))?;
//! let class = &session.scene.model.class;
//! let detector = EvaluatedDetector::recorded(Manifest::named("yolox_nano")?, &[&session.folder], class)?;
//! let scores = score(vec![session], vec![detector], &Options::default(), || ())?;
//! println!("{}", summary_table(&scores));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod report;

pub mod cache;
mod caution;
pub mod compare;
mod contradicted;
pub mod corrupt;
mod criteria;
mod curves;
mod decoded;
mod disagreement;
mod error;
mod evaluated;
pub mod grouping;
mod labelled;
mod left_out;
mod near_copies;
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
    ClusteredBy, CompareError, Compared, Comparison, Control, Course, Decision, Difference, Effect, Expected, FewViews,
    Finding, InPlacesLikeThese, MOST_HIT, Observed, PLAN_EXPERIMENTS, PLAN_SEED, PlanCheck, PlanError, Question,
    SEQUENTIAL_ROWS, Sequential, SequentialFinding, SequentialPlan, Spread, SpreadFrom, ViewsNeeded, check_control,
    compare, compare_with, decide, decide_by_looks, most_telling, moved_drops, paired, paired_control, paired_photos,
    sequential, sequential_plan,
};
pub use corrupt::{Corruption, SEVERITIES};
pub use criteria::Criteria;
pub use curves::{Curves, HitRateFrom, curves};
pub use disagreement::disagreements;
pub use error::ScoreError;
pub use evaluated::{DetectionSource, EvaluatedDetector, EvaluatedDetectorError, evaluated_detectors, runtime};
pub use grouping::{GroupBy, GroupByError};
pub use labelled::{Averages, LEAST_GAIN, LabelledError, LabelledPhotos, Trial, Trials, labelled_photos, trials};
pub use left_out::{SessionFiles, explained, not_scored};
pub use observe::{NotScoredReason, Options};
pub use outcome::{PhotoOutcome, Thresholds, Verdict};
pub use photo::{NotScored, ScoredPhoto, TagMark};
pub use protocol::Protocol;
pub use protocol_table::{ProtocolTable, apricot_ap, protocol_table, rates_as_armory};
pub use ranking::{Ranking, RankingFinding, RankingRow, ranking};
pub use record::{RecordError, check_recordings, record};
pub use reliability::{ConfidenceBin, RELIABILITY_FLOOR, Reliability, reliability};
pub use robustness::{
    BASE_LOST, CorruptedRow, DefenceCard, Defences, DefendedRow, Defending, Held, Robustness, Survival, UNDEFENDED,
    check_changeable, under_corruption, under_defences,
};
pub use run::{TimedPhoto, merge, observe, score, timed_photos};
pub use scaleproof_core::ap::{ApDefinition, ImageBoxes, average_precision, average_precision_as, over_ious};
use scores::ScoredSet;
pub use scores::Scores;
pub use sealed::{Aim, Endpoint, SealedDetector, SealedFile, SealedPlan, Stopping};
pub use settings::{AppliedSettings, Settings};
pub use summary::{Asr, BinFigures, CellFigures, ConditionFigures, Drop, Figures, Rate, Summary};
pub use transfer::{TransferDrop, TransferRow, transfer};
pub use worn::WornPattern;

/// Least IoU with the truth box at which a detection counts for the model.
pub const MATCH_IOU: f64 = 0.5;

/// Least confidence of the matching detection at which a photo counts as a hit, unless [`Criteria`] say otherwise.
pub const HIT_CONFIDENCE: f64 = 0.5;

pub const BASE_VARIANT: &str = "normal";

/// Returns (name, definition) of each word of a comparison; they are stored beside its numbers.
pub fn comparison_definitions() -> impl Iterator<Item = (&'static str, &'static str)> {
    let lines = include_str!("compare/definitions.txt").lines();
    lines.filter_map(|line| line.split_once(" | "))
}
