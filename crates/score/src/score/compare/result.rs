//! What a comparison says: differences with their intervals and findings.

use serde::{Deserialize, Serialize};

use crate::score::NotScored;
use scaleproof_core::statistics::Interval;

/// Photos that are taken as dependent on each other, and so counted together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ClusteredBy {
    /// Those of one place: what is found holds for places like these.
    Place,
    /// Those of one place and bin: what is found holds for these places.
    PlaceAndBin,
}

/// What the photos can tell of a difference, after correction for the number of tests (explained in comparing.md).
///
/// The hit rate is the primary endpoint: McNemar's exact p, corrected by Holm for all detectors × textures of the comparison. Mean confidence, AP and single
/// directions are secondary: nothing is shown of them where the hit rate of the same detector and texture is not shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Finding {
    /// The base is better.
    Drop,
    /// The base is worse.
    Rise,
    /// The test or interval of this figure alone would show a difference at 5 %; after correction it is not shown.
    NotAfterCorrection,
    /// No difference is shown, and one of 0.2 or more is excluded.
    NoDifferenceShown,
    /// There are fewer than six clusters, or no difference is shown and one of 0.2 is not excluded.
    TooFewPhotosToTell,
}

/// One figure on both sides of the pairs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Difference {
    /// The figure of the base; `other` is that of the variant.
    pub base: f64,
    pub other: f64,
    /// `base` minus `other`.
    pub drop: f64,
    /// 95 % interval of the drop; `null` with too few clusters, and when all clusters differ alike.
    pub interval_95: Option<Interval>,
    pub finding: Finding,
    /// Attack success rate, 1 − `other` ÷ `base`; `null` where the base is 0.
    pub asr: Option<f64>,
    /// 95 % interval of the attack success rate; `null` also where too many resamples of the base are 0.
    pub asr_interval_95: Option<Interval>,
}

/// Hits on both sides of the pairs, and the exact test of their difference.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Hits {
    #[serde(flatten)]
    pub rate: Difference,
    /// Pairs hit on the base side alone.
    pub base_alone: usize,
    /// Pairs hit on the other side alone.
    pub other_alone: usize,
    /// McNemar's exact p, two-sided.
    pub mcnemar_p: f64,
}

/// The hits of one azimuth bin.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct BinHits {
    /// Azimuth of the bin's centre.
    pub azimuth_deg: f64,
    pub pairs: usize,
    pub clusters: usize,
    pub hits: Hits,
    /// McNemar's p corrected by Holm over the bins that have enough clusters; `null` in the others.
    pub holm_p: Option<f64>,
}

/// One detector on one variant, against the base.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Compared {
    pub detector: String,
    pub variant: String,
    /// Pairs of photos.
    pub pairs: usize,
    /// What is resampled as a whole: `place` from six places on, else `place_and_bin`.
    pub clustered_by: ClusteredBy,
    /// How many clusters are resampled.
    pub clusters: usize,
    /// Near-copies of the photos of these pairs, which count once with them.
    pub near_copies: usize,
    /// Places that have pairs.
    pub places: usize,
    /// Bins that have pairs.
    pub bins: usize,
    /// The primary endpoint.
    pub hit_rate: Hits,
    /// McNemar's p of the hit rate, corrected by Holm for the `tests` of the comparison.
    pub holm_p: f64,
    /// Detectors × textures that were tested together.
    pub tests: usize,
    pub mean_confidence: Difference,
    pub ap50: Difference,
    pub azimuth_bins: Vec<BinHits>,
}

/// What pairs had shown when they were enough.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SequentialFinding {
    /// The base is better.
    Drop,
    /// The base is worse.
    Rise,
    /// The drop is smaller than the least that matters (`--least`).
    LessThanLeast,
    /// Nothing is shown so far.
    Undecided,
}

/// One figure after all looks.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Decision {
    /// Mean of the differences that were looked at, base minus other.
    pub drop: f64,
    /// What was shown first.
    pub finding: SequentialFinding,
    /// Looks until something was shown; `null` while nothing is.
    pub decided_after: Option<usize>,
    /// p of "the texture changes nothing in any view"; holds however often one looks, for this test alone.
    pub p_always_valid: f64,
    /// The p of the hit rate corrected by Holm over the detectors, times the number of textures; `null` for other figures.
    pub p_corrected: Option<f64>,
    /// Whole rounds, in which every bin has its pair; where looks are after each place, the number of places.
    pub rounds: usize,
    /// 95 % interval of the mean drop over bins (or places), valid at every look; `null` before a whole round, or when rounds conflict.
    pub interval_95: Option<Interval>,
    /// Base-10 logarithm of the evidence for a drop after each look; from 1.6 (a factor of 40) on one test alone would show it.
    pub log10_evidence: Vec<f64>,
}

/// One detector on one variant, look by look.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Course {
    pub detector: String,
    pub variant: String,
    /// How many looks there were: pairs, or places.
    pub looks: usize,
    /// Pairs that repeat a place and bin, which are not looked at.
    pub repeats: usize,
    pub hit_rate: Decision,
    pub mean_confidence: Decision,
}

/// Every variant against the base, look by look.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Sequential {
    /// What is added between two looks.
    pub look_after_each: ClusteredBy,
    /// The drop that matters (`--least`); `null` where none is named.
    pub least: Option<f64>,
    pub results: Vec<Course>,
}

/// Which plan a comparison was held against, and in what it differs.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct PlanCheck {
    /// SHA-256 of the plan; what was published of it must be the same.
    pub seal: String,
    /// In what the comparison differs from the plan, as sentences.
    pub deviations: Vec<String>,
}

/// Every variant of a run against its base.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Comparison {
    /// The plan that was fixed before the photos, with `--plan`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plan: Option<PlanCheck>,
    /// The variant that the others are compared with.
    pub base: String,
    /// Definition of average precision: `coco-101`, `all-point`, `voc-11` or `yolov5-ramp`.
    pub ap_definition: &'static str,
    /// Resamples behind each interval.
    pub bootstrap_draws: usize,
    /// Seed of the resampling.
    pub bootstrap_seed: u64,
    /// One for each detector and other variant.
    pub results: Vec<Compared>,
    /// Scored photos that are in no difference.
    pub unpaired: Vec<NotScored>,
    /// With `--sequential`: every variant against the base, look by look.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sequential: Option<Sequential>,
}
