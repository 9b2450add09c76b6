//! Results of a comparison: differences with their intervals and findings.

use serde::{Deserialize, Serialize};

use crate::figures::{Effect, Finding, NotScored};
use scaleproof_core::statistics::Interval;
use scaleproof_pose::scene::Bin;

/// Photos that are taken as dependent on each other, and so counted together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ClusteredBy {
    /// Those of one place: what is found holds for places like these.
    Place,
    /// Those of one place and bin: what is found holds for these places.
    PlaceAndBin,
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
    /// Attack success rate, 1 − `other` ÷ `base`; `null` where the base is 0.
    pub asr: Option<f64>,
    /// 95 % interval of the attack success rate; `null` also where too many resamples of the base are 0.
    pub asr_interval_95: Option<Interval>,
}

/// Hits on both sides of the pairs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Hits {
    #[serde(flatten)]
    pub rate: Difference,
    /// Pairs hit on the base side alone.
    pub base_alone: usize,
    /// Pairs hit on the other side alone.
    pub other_alone: usize,
}

/// The hits of one azimuth bin.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct BinHits {
    /// Azimuth of the bin's centre.
    pub azimuth_deg: f64,
    pub pairs: usize,
    pub clusters: usize,
    pub hits: Hits,
}

/// One detector on one variant, against the base.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Compared {
    pub detector: String,
    pub variant: String,
    /// Pairs of photos.
    pub pairs: usize,
    /// Near-copies of the photos of these pairs, which count once with them.
    pub near_copies: usize,
    /// Places that have pairs.
    pub places: usize,
    /// Bins that have pairs.
    pub bins: usize,
    /// Views that have pairs, each of a place and bin: what is resampled for the intervals, and what changes its sign in the tests.
    pub clusters: usize,
    /// Finding; `null` where nothing was tested, and intervals are all there is.
    pub finding: Option<Finding>,
    /// The primary endpoint.
    pub mean_confidence: Difference,
    /// The secondary endpoint.
    pub hit_rate: Hits,
    pub ap50: Difference,
    pub azimuth_bins: Vec<BinHits>,
    /// Differences behind the findings, by view.
    #[serde(skip)]
    pub(crate) views: Vec<PairedView>,
}

impl Compared {
    /// Returns the effect that is shown; `NothingShown` where nothing was tested.
    pub fn effect(&self) -> Effect {
        self.finding.map_or(Effect::NothingShown, |finding| finding.effect)
    }

    /// Returns the numbers of pairs that are hit on the base side and on the other.
    pub fn hits(&self) -> [usize; 2] {
        let rates = [self.hit_rate.rate.base, self.hit_rate.rate.other];
        rates.map(|rate| (rate * self.pairs as f64).round() as usize)
    }
}

/// The pairs of one place and bin.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PairedView {
    pub place: String,
    pub bin: Bin,
    pub all: Sums,
    /// Sums without pairs of which a photo shows what an earlier one shows.
    pub once: Sums,
}

/// Sums over pairs, base minus other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sums {
    pub pairs: usize,
    pub confidence_lost: f64,
    pub hits_lost: f64,
}

impl PairedView {
    pub(crate) fn sums(&self) -> Option<Sums> {
        Some(self.all)
    }

    /// Returns the sums without repeats; `None` where every pair shows again what others show.
    pub(crate) fn sums_once(&self) -> Option<Sums> {
        (self.once.pairs > 0).then_some(self.once)
    }

    pub(crate) fn has_repeats(&self) -> bool {
        self.once.pairs < self.all.pairs
    }
}

/// Finding of a sequential test, when its pairs were enough.
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
    /// First finding.
    pub finding: SequentialFinding,
    /// Looks until something was shown; `null` while nothing is.
    pub decided_after: Option<usize>,
    /// p of "the texture changes nothing in any view"; holds however often one looks, for this test alone.
    pub p_always_valid: f64,
    /// The p of the mean confidence corrected by Holm over the detectors, times the number of textures; `null` for other figures.
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
    /// Number of looks: pairs, or places.
    pub looks: usize,
    /// Pairs that repeat a place and bin, which are not looked at.
    pub repeats: usize,
    /// Effect that is shown so far, however often one looks.
    pub effect: Effect,
    pub mean_confidence: Decision,
    pub hit_rate: Decision,
}

/// Every variant against the base, look by look.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Sequential {
    /// Unit that is added between two looks.
    pub look_after_each: ClusteredBy,
    /// The drop that matters (`--least`); `null` where none is named.
    pub least: Option<f64>,
    pub results: Vec<Course>,
}

/// Plan that a comparison was checked against, and its deviations from it.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct PlanCheck {
    /// SHA-256 of the plan; what was published of it must be the same.
    pub seal: String,
    /// True if the comparison is judged by McNemar's exact p of the hit rate, corrected by Holm, as the plan was sealed.
    pub judged_by_hit_rate: bool,
    /// Deviations of the comparison from the plan, as sentences.
    pub deviations: Vec<String>,
}

/// The second plain round, against the first.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Control {
    /// The variant that is a second plain round.
    pub variant: String,
    /// One for each detector, by intervals alone: nothing is tested, and no share of an error rate used.
    pub results: Vec<Compared>,
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
    /// With `--control`: a second plain round, which holds back what it moves by as much.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub control: Option<Control>,
    /// Scored photos that are in no difference.
    pub unpaired: Vec<NotScored>,
    /// With `--sequential`: every variant against the base, look by look.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sequential: Option<Sequential>,
}
