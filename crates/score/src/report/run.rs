//! Content of a run's report, put together once for all writers.

use crate::figures::Scores;
use crate::report::Findings;
use crate::report::tables::RunTables;
use scaleproof_detect::Speeds;

/// Findings and tables of a run, and the times of its detectors, if they are known.
pub struct RunReport<'a> {
    pub scores: &'a Scores,
    pub findings: Findings<'a>,
    pub tables: RunTables,
    pub speeds: Option<&'a Speeds>,
}

impl<'a> RunReport<'a> {
    pub fn new(scores: &'a Scores, speeds: Option<&'a Speeds>) -> RunReport<'a> {
        let findings = Findings::of_run(scores);
        let tables = RunTables::new(findings);
        RunReport {
            scores,
            findings,
            tables,
            speeds,
        }
    }
}
