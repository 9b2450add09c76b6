//! What is left of the differences when photos get worse.

use serde::Serialize;

use crate::score::Difference;

/// Every comparison at every severity.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Robustness {
    /// By corruption, severity (from 0), then base, variant and detector.
    pub rows: Vec<CorruptedRow>,
    pub survival: Vec<Survival>,
}

impl Robustness {
    /// Their names, in the order in which they were asked for.
    pub(crate) fn corruptions(&self) -> Vec<&'static str> {
        let mut names: Vec<&str> = self.rows.iter().map(|row| row.corruption).collect();
        names.dedup();
        names
    }
}

/// A variant against its base on photos of one severity.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct CorruptedRow {
    pub corruption: &'static str,
    /// 0 is the photo as it is, at the size of the others.
    pub severity: u8,
    /// What the severity means.
    pub amount: String,
    pub base: String,
    pub variant: String,
    pub detector: String,
    pub pairs: usize,
    pub ap50: Difference,
    pub hit_rate: Difference,
    pub mean_confidence: Difference,
}

/// How far a drop of AP goes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Survival {
    pub corruption: &'static str,
    pub base: String,
    pub variant: String,
    pub detector: String,
    /// The first severity at which no drop is shown; absent where one is shown at all.
    pub not_shown_from: Option<u8>,
}
