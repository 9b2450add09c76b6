//! Agreement of two orders of the variants.

use serde::Serialize;

use scaleproof_core::statistics::Interval;

/// Finding on the agreement of two orders.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum RankingFinding {
    /// They agree more than they differ, at the level of 5 %.
    Holds,
    /// They differ more than they agree, at the level of 5 %.
    Reversed,
    /// Neither is shown.
    TooFewPhotosToTell,
}

/// A variant in both orders.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct RankedVariant {
    pub variant: String,
    /// AP@0.5 in this run; `other_ap50` is that in the other sessions.
    pub ap50: f64,
    pub other_ap50: f64,
}

/// The order of one detector, over all photos or those of one condition.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct RankingRow {
    pub detector: String,
    /// `all`, or a condition and its value, as in `distance 850`.
    pub photos: String,
    /// From the highest AP to the lowest.
    pub variants: Vec<RankedVariant>,
    /// Places and bins that have photos of all these variants, here and in the other sessions.
    pub cells: [usize; 2],
    /// Clusters that are resampled as a whole, here and in the other sessions.
    pub clusters: [usize; 2],
    /// Kendall's τ-b of the two orders; `null` where one of them has nothing but ties.
    pub tau: Option<f64>,
    /// 95 % interval of `tau`; `null` with too few clusters, and when all resamples agree.
    pub interval_95: Option<Interval>,
    pub finding: RankingFinding,
}

/// The orders of a run against those of other sessions.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Ranking {
    /// Names of the other sessions' folders.
    pub others: Vec<String>,
    /// One row for each detector, and with `--group-by` for each value of a condition.
    pub rows: Vec<RankingRow>,
    /// Cautions on what could not be compared, as sentences.
    pub cautions: Vec<String>,
}
