//! An evaluation of patterns: the paper's tables (DTA, tables 1 and 2) and the paired differences behind them.

use crate::evaluated::EvaluatedDetector;
use crate::figures::{Compared, Comparison, Figures, Scores};

pub struct Evaluation<'a> {
    pub scores: &'a Scores,
    /// The variants as the tables list them, the base first.
    pub patterns: Vec<String>,
    /// Names of the detectors that the patterns were made against; table 1 has them, table 2 the others. All are in table 1 when empty.
    pub targets: Vec<String>,
    /// Each variant against those listed after it, the base's first.
    pub comparisons: Vec<Comparison>,
}

impl<'a> Evaluation<'a> {
    pub fn targets(&self) -> Vec<&'a EvaluatedDetector> {
        self.detectors(|name| self.targets.is_empty() || self.targets.iter().any(|t| t == name))
    }

    pub fn others(&self) -> Vec<&'a EvaluatedDetector> {
        let targets = self.targets();
        self.detectors(|name| targets.iter().all(|t| t.manifest.name != name))
    }

    fn detectors(&self, keep: impl Fn(&str) -> bool) -> Vec<&'a EvaluatedDetector> {
        let all = self.scores.detectors.iter();
        all.filter(|c| keep(&c.manifest.name)).collect()
    }

    pub(crate) fn figures(&self, pattern: &str, detector: &EvaluatedDetector) -> Option<&'a Figures> {
        let own = self.scores.summary(&detector.manifest.name, pattern);
        own.map(|s| &s.overall)
    }

    /// Returns `pattern` compared with `base` on pairs; `base` is listed before `pattern`.
    pub(crate) fn compared(&self, base: &str, pattern: &str, detector: &EvaluatedDetector) -> Option<&Compared> {
        let comparison = self.comparisons.iter().find(|c| c.base == base)?;
        let of = |r: &&Compared| r.variant == pattern && r.detector == detector.manifest.name;
        comparison.results.iter().find(of)
    }
}

/// Scope of the intervals.
pub(crate) const SCOPE: &str = "95 % intervals: bootstrap over viewpoint and light, the photos paired by both; they hold for this model, these lights \
                                and renders, not for others";
