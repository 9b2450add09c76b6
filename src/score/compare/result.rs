//! What a comparison says: differences with their intervals and findings.

use serde::Serialize;

use crate::statistics::Interval;

/// Photos that are taken as dependent on each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ClusteredBy {
    /// Those of one place: what is found holds for places like these.
    Place,
    /// Those of one place and bin: what is found holds for these places.
    PlaceAndBin,
}

/// What the photos can tell of a difference.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Finding {
    /// The base is better, at the level of 5 %.
    Drop,
    /// The base is worse, at the level of 5 %.
    Rise,
    /// None shown, and one of 0.2 or more is excluded.
    NoDifferenceShown,
    TooFewPhotosToTell,
}

/// One figure on both sides of the pairs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Difference {
    pub base: f64,
    pub other: f64,
    /// `base` minus `other`.
    pub drop: f64,
    /// Of the drop; absent with too few clusters, and when all clusters differ alike.
    pub interval_95: Option<Interval>,
    pub finding: Finding,
    /// Attack success rate, 1 − `other` ÷ `base`; absent where the base is 0.
    pub asr: Option<f64>,
    /// Of the attack success rate; absent also where too many resamples of the base are 0.
    pub asr_interval_95: Option<Interval>,
}

/// Hits on both sides of the pairs, and the exact test of their difference.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
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
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BinHits {
    pub azimuth_deg: f64,
    pub pairs: usize,
    pub clusters: usize,
    pub hits: Hits,
    /// p corrected over the bins that have enough clusters; absent in the others.
    pub holm_p: Option<f64>,
}

/// One detector on one variant, against the base.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Compared {
    pub detector: String,
    pub variant: String,
    pub pairs: usize,
    /// What is resampled as a whole.
    pub clustered_by: ClusteredBy,
    pub clusters: usize,
    /// Places that have pairs.
    pub places: usize,
    /// Bins that have pairs.
    pub bins: usize,
    pub hit_rate: Hits,
    pub mean_confidence: Difference,
    pub ap50: Difference,
    pub azimuth_bins: Vec<BinHits>,
}

/// Every variant of a run against its base.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// The variant that the others are compared with.
    pub base: String,
    /// Name of the definition of average precision.
    pub ap_definition: &'static str,
    /// Resamples behind each interval.
    pub bootstrap_draws: usize,
    /// Seed of the resampling.
    pub bootstrap_seed: u64,
    /// One for each detector and other variant.
    pub results: Vec<Compared>,
    /// Scored photos that are in no difference.
    pub unpaired: Vec<Unpaired>,
}

/// A scored photo that has no partner, and why.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Unpaired {
    pub session: String,
    pub file: String,
    pub variant: String,
    /// A sentence.
    pub reason: String,
}
