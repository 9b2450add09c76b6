//! Photos, poses and detections become numbers: truth boxes, matching, AP, rates, drops.

mod cache;
mod caution;
mod compare;
mod criteria;
mod decoded;
mod error;
mod evaluated;
mod observe;
mod outcome;
mod photo;
mod preview;
mod record;
mod reliability;
mod run;
mod scores;
pub mod shard;
mod summary;
mod transfer;

pub use crate::ap::{ApDefinition, AveragePrecision, ImageBoxes, average_precision, average_precision_as};
pub use cache::Cache;
pub use compare::{
    BinHits, CompareError, Compared, Comparison, Difference, Finding, Hits, PlanError, Unpaired, compare, compare_with,
    pairs_needed, power,
};
pub use criteria::Criteria;
pub use error::ScoreError;
pub use evaluated::{DetectionSource, EvaluatedDetector, EvaluatedDetectorError, evaluated_detectors, runtime};
pub use observe::{LeftOutReason, Observation, Options, libraries};
pub use outcome::{PhotoOutcome, Verdict};
pub use photo::{NotScored, ScoredPhoto, TagMark};
pub use record::{RecordError, check_recordings, record};
pub use reliability::{ConfidenceBin, RELIABILITY_FLOOR, Reliability, reliability};
pub use run::{merge, observe, score};
pub use scores::Scores;
pub use summary::{BinFigures, CellFigures, Drop, Figures, PlaceFigures, Rate, Summary};
pub use transfer::{TransferDrop, TransferRow, transfer};

/// A detection counts for the model when their boxes overlap by at least this much.
pub const MATCH_IOU: f64 = 0.5;

/// A photo counts as a hit when the matching detection is at least this confident, unless [`Criteria`] say otherwise.
pub const HIT_CONFIDENCE: f64 = 0.5;

/// The variant that drops are measured from.
pub const BASE_VARIANT: &str = "normal";

/// What the words of a comparison mean, stored beside its numbers: (name, definition).
pub const COMPARISON_DEFINITIONS: [(&str, &str); 5] = [
    (
        "pairs",
        "a photo of the base and one of the variant from the same place and bin, in the order of the sessions; photos left over are listed and \
         in no figure",
    ),
    (
        "95 % interval",
        "of the drop: bootstrap over clusters (place × bin), drawn with multiplicity, percentiles widened for few clusters (Hesterberg 2015)",
    ),
    (
        "mcnemar_p",
        "exact and two-sided, on the hits; the pairs of one cluster change sides together",
    ),
    (
        "holm_p",
        "McNemar's p, corrected over the azimuth bins that have six clusters or more",
    ),
    (
        "too few photos to tell",
        "fewer than six clusters, or no difference shown at 5 % while one of 0.2 either way is not excluded by the interval",
    ),
];
