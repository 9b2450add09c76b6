//! Transfer of a pattern made against one detector to the others: drops as a matrix, pattern × detector.

use serde::Serialize;

use crate::figures::{Drop, Summary};

/// The drops of one variant over all photos.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct TransferRow {
    pub variant: String,
    /// The drop of each detector, in the order of the run.
    pub detectors: Vec<TransferDrop>,
}

/// The drop of one detector.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct TransferDrop {
    pub detector: String,
    #[serde(flatten)]
    pub drop: Drop,
}

/// Returns a row for every variant but the base, in the order of the summaries; none when the run has no base.
pub fn transfer(summaries: &[Summary]) -> Vec<TransferRow> {
    let mut rows: Vec<TransferRow> = Vec::new();
    for (summary, drop) in summaries.iter().filter_map(|s| Some((s, s.drop?))) {
        let detector = TransferDrop {
            detector: summary.detector.clone(),
            drop,
        };
        match rows.iter_mut().find(|row| row.variant == summary.variant) {
            Some(row) => row.detectors.push(detector),
            None => rows.push(TransferRow {
                variant: summary.variant.clone(),
                detectors: vec![detector],
            }),
        }
    }
    rows
}
