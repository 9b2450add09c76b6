//! Photos, poses and detections become numbers: truth boxes, matching, AP, rates, drops.

mod ap;
mod cache;
mod caution;
mod compare;
mod contestant;
mod observe;
mod outcome;
mod photo;
mod preview;
mod run;
pub mod shard;
mod summary;
mod truth;
mod wilson;

pub use ap::{ApDefinition, AveragePrecision, ImageBoxes, average_precision, average_precision_as};
pub use cache::Cache;
pub use compare::{
    BinHits, CompareError, Compared, Comparison, Difference, Finding, Hits, Interval, PlanError, Unpaired, compare,
    holm, interval_95, mcnemar_p, pairs_needed, power,
};
pub use contestant::{Contestant, ContestantError, Source};
pub use observe::{Observation, Options};
pub use outcome::{Outcome, Verdict};
pub use photo::{NotScored, ScoredPhoto};
pub use run::{ScoreError, Scores, libraries, merge, observe, runtime, score};
pub use summary::{BinFigures, Drop, Figures, Rate, Summary};
pub use truth::{NoTruth, box_from_pose};
pub use wilson::wilson_95;

/// A detection counts for the model when their boxes overlap by at least this much.
pub const MATCH_IOU: f64 = 0.5;

/// A photo counts as a hit when the matching detection is at least this confident.
pub const HIT_CONFIDENCE: f64 = 0.5;

/// The variant that drops are measured from.
pub const BASE_VARIANT: &str = "normal";

/// What each number means, printed beside the numbers: (name, definition).
pub const DEFINITIONS: [(&str, &str); 5] = [
    (
        "AP@0.5",
        "average precision of the model's class at IoU ≥ 0.5, COCO definition (101 recall points, at most 100 detections a \
         photo, candidates from confidence 0.001 up)",
    ),
    (
        "hit rate",
        "share of photos with a detection of the model's class at confidence ≥ 0.5 and IoU ≥ 0.5 with the truth box",
    ),
    (
        "95 % interval",
        "Wilson score interval of the hit rate; it treats photos as independent",
    ),
    (
        "confidence",
        "mean over photos of the highest confidence among detections of the model's class at IoU ≥ 0.5; a photo without one \
         counts 0",
    ),
    (
        "drop",
        "the figure of the variant “normal” minus the figure of this variant, same detector",
    ),
];

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
