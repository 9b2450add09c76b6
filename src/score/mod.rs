//! Photos, poses and detections become numbers: truth boxes, matching, AP, rates, drops.

mod cache;
mod caution;
mod compare;
mod criteria;
mod decoded;
mod error;
mod evaluated;
mod labelled;
mod observe;
mod outcome;
mod photo;
mod preview;
mod record;
mod reliability;
mod run;
mod scores;
pub(crate) mod shard;
mod summary;
mod transfer;

pub use crate::ap::ApDefinition;
pub(crate) use crate::ap::{ImageBoxes, average_precision_as};
#[cfg(test)]
pub(crate) use crate::ap::{average_precision, over_ious};
pub use cache::Cache;
#[cfg(test)]
pub(crate) use compare::power;
pub use compare::{CompareError, Comparison, compare};
pub(crate) use compare::{Compared, Difference, Finding, compare_with, pairs_needed};
pub use criteria::Criteria;
pub use error::ScoreError;
pub(crate) use evaluated::{DetectionSource, evaluated_detectors, runtime};
pub use evaluated::{EvaluatedDetector, EvaluatedDetectorError};
pub(crate) use labelled::{Averages, LabelledError, LabelledPhotos, feedings};
pub use observe::Options;
pub(crate) use observe::{NotScoredReason, libraries};
pub(crate) use outcome::{PhotoOutcome, Verdict};
pub(crate) use photo::TagMark;
pub use photo::{NotScored, ScoredPhoto};
pub(crate) use record::{RecordError, check_recordings, record};
pub(crate) use reliability::{ConfidenceBin, RELIABILITY_FLOOR, Reliability, reliability};
pub use run::score;
pub(crate) use run::{merge, observe};
pub use scores::Scores;
pub(crate) use summary::{BinFigures, CellFigures, Drop, Figures, Rate, Summary};
pub(crate) use transfer::{TransferDrop, TransferRow, transfer};

/// A detection counts for the model when their boxes overlap by at least this much.
pub(crate) const MATCH_IOU: f64 = 0.5;

/// A photo counts as a hit when the matching detection is at least this confident, unless [`Criteria`] say otherwise.
pub(crate) const HIT_CONFIDENCE: f64 = 0.5;

/// The variant that drops are measured from.
pub(crate) const BASE_VARIANT: &str = "normal";

/// What the words of a comparison mean, stored beside its numbers: (name, definition).
pub(crate) fn comparison_definitions() -> impl Iterator<Item = (&'static str, &'static str)> {
    let lines = include_str!("compare/definitions.txt").lines();
    lines.filter_map(|line| line.split_once(" | "))
}
