//! `evaluation.tex`: the paper's tables of patterns × detectors.

use crate::report::latex::comments::commented;
use crate::report::{Evaluation, tables};

/// Returns the paper's two tables: pattern × detector.
pub(crate) fn evaluation(evaluation: &Evaluation) -> String {
    let comment = format!(
        "% scaleproof {}. Needs \\usepackage{{booktabs}}. AP@0.5: {}. Confidence: mean, misses count 0.\n\
         % Counts as the model: {}.",
        env!("CARGO_PKG_VERSION"),
        evaluation.scores.criteria.ap.name(),
        commented(evaluation.scores)
    );
    let tables = tables::by_pattern(evaluation, usize::MAX).into_iter();
    let tables = tables.map(|table| format!("% {}.\n{}", table.caption, table.tex()));
    format!("{comment}\n{}", tables.collect::<String>())
}
