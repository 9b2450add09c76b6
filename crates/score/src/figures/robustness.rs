//! Differences between variants on corrupted photos.

use serde::Serialize;

use crate::figures::{Compared, Difference, Finding};
use scaleproof_core::statistics::{ALIKE, FEWEST_CLUSTERS};

/// Every comparison at every severity.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Robustness {
    /// By corruption, severity (from 0), then base, variant and detector.
    pub rows: Vec<CorruptedRow>,
    /// The photos of each variant at each severity from 1 on (`other` in figures) against the same photos reduced alone (`base`).
    pub changes: Vec<CorruptedRow>,
    /// Survival of the drop of AP, for each corruption, base, variant and detector.
    pub survival: Vec<Survival>,
    /// Further cautions, as sentences.
    pub cautions: Vec<String>,
}

impl Robustness {
    /// Returns the names of the corruptions, in the order in which they were chosen.
    pub fn corruptions(&self) -> Vec<&'static str> {
        let mut names: Vec<&str> = self.rows.iter().map(|row| row.corruption).collect();
        names.dedup();
        names
    }
}

/// A variant against its base on photos of one severity.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct CorruptedRow {
    /// Name of the corruption (scoring.md lists them).
    pub corruption: &'static str,
    /// 0 to 5; 0 is the photo reduced to 640 px like the others, no worse.
    pub severity: u8,
    /// Amount of the severity; empty for severity 0.
    pub amount: String,
    #[serde(flatten)]
    pub difference: PairedDifference,
}

/// A variant against its base, on photos of one kind.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct PairedDifference {
    pub base: String,
    pub variant: String,
    pub detector: String,
    /// Pairs of photos.
    pub pairs: usize,
    /// Finding on photos that were changed, against the same photos as they were; `null` where textures are compared, by intervals alone.
    pub finding: Option<Finding>,
    pub mean_confidence: Difference,
    pub hit_rate: Difference,
    pub ap50: Difference,
}

impl PairedDifference {
    pub(crate) fn new(base: &str, compared: Compared) -> Self {
        Self {
            base: base.to_owned(),
            variant: compared.variant,
            detector: compared.detector,
            pairs: compared.pairs,
            finding: compared.finding,
            mean_confidence: compared.mean_confidence,
            hit_rate: compared.hit_rate.rate,
            ap50: compared.ap50,
        }
    }

    /// Returns true if it compares the same variants by the same detector.
    pub(crate) fn is_as(&self, other: &Self) -> bool {
        [&self.base, &self.variant, &self.detector] == [&other.base, &other.variant, &other.detector]
    }

    /// Returns true if the 95 % interval of the drop of AP lies above 0, or the drop itself where all resamples agree; `None` where there are too few
    /// pairs for either.
    pub fn is_above_zero(&self) -> Option<bool> {
        match self.ap50.interval_95 {
            Some(interval) => Some(interval.low > 0.0),
            None => (self.pairs >= FEWEST_CLUSTERS).then_some(self.ap50.drop > ALIKE),
        }
    }
}

/// Survival of a drop of AP over the severities of a corruption.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Survival {
    pub corruption: &'static str,
    pub base: String,
    pub variant: String,
    pub detector: String,
    /// The severities at which the 95 % interval of the drop of AP lies above 0.
    pub above_zero_at: Vec<u8>,
    /// The severities at which the base itself has an AP below 0.2, which leaves hardly anything to drop.
    pub base_lost_at: Vec<u8>,
    /// The severities at which the pairs are too few for an interval.
    pub without_interval_at: Vec<u8>,
}

/// AP of the base below which there is no room for a drop.
pub const BASE_LOST: f64 = 0.2;

impl Survival {
    /// Makes the survival of the rows of one corruption and comparison, in the order of severities.
    pub(crate) fn of<'a>(first: &CorruptedRow, own: impl Iterator<Item = &'a CorruptedRow> + Clone) -> Self {
        let at =
            |is: &dyn Fn(&CorruptedRow) -> bool| own.clone().filter(|row| is(row)).map(|row| row.severity).collect();
        Self {
            corruption: first.corruption,
            base: first.difference.base.clone(),
            variant: first.difference.variant.clone(),
            detector: first.difference.detector.clone(),
            above_zero_at: at(&|row| row.difference.is_above_zero() == Some(true)),
            base_lost_at: at(&|row| row.difference.ap50.base < BASE_LOST),
            without_interval_at: at(&|row| row.difference.is_above_zero().is_none()),
        }
    }
}
