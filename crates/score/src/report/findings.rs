//! A run and its comparisons with a base, which a report is about.

use crate::compare::{paired, paired_control};
use crate::figures::{BASE_VARIANT, Compared, Comparison, PlanCheck, Scores};
use crate::report::Evaluation;

/// A run and its comparisons with a base.
#[derive(Clone, Copy)]
pub struct Findings<'a> {
    pub scores: &'a Scores,
    /// One for each detector and texture whose photos pair with those of the base.
    pub results: &'a [Compared],
    /// One for each detector: the second round of the base.
    pub control: &'a [Compared],
    pub base: &'a str,
    /// The plan that was sealed before the photos.
    pub plan: Option<&'a PlanCheck>,
    /// True if they are those of a sequential test, after each pair or place.
    pub is_sequential: bool,
}

impl<'a> Findings<'a> {
    /// Compares every texture of a run with its base.
    pub fn of_run(scores: &'a Scores) -> Self {
        Findings::new(scores, paired(scores), &scores.base)
    }

    pub fn of_comparison(scores: &'a Scores, comparison: &'a Comparison) -> Self {
        Findings {
            plan: comparison.plan.as_ref(),
            is_sequential: comparison.sequential.is_some(),
            ..Findings::new(scores, &comparison.results, &comparison.base)
        }
    }

    /// Returns the comparisons of an evaluation with the plain model.
    pub fn of_evaluation(evaluation: &'a Evaluation) -> Self {
        let with_base = evaluation.comparisons.iter().find(|c| c.base == BASE_VARIANT);
        let results = with_base.map_or(&[][..], |comparison| &comparison.results);
        Findings::new(evaluation.scores, results, BASE_VARIANT)
    }

    fn new(scores: &'a Scores, results: &'a [Compared], base: &'a str) -> Self {
        Findings {
            scores,
            results,
            control: paired_control(scores),
            base,
            plan: None,
            is_sequential: false,
        }
    }

    /// Returns the comparison of a variant, or of the control, for one detector; `None` where no photos pair.
    pub fn compared(&self, detector: &str, variant: &str) -> Option<&'a Compared> {
        let mut all = self.results.iter().chain(self.control);
        all.find(|r| r.detector == detector && r.variant == variant)
    }
}
