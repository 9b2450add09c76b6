//! An evaluation of patterns for the terminal.

use crate::report::words::{counted, verdict};
use crate::report::{Evaluation, Findings, tables};

/// Returns the verdict, the paper's tables, and the differences of AP@0.5 with their intervals.
pub fn evaluation_tables(evaluation: &Evaluation) -> String {
    let scores = evaluation.scores;
    let mut lines = verdict::sentences(Findings::of_evaluation(evaluation));
    for table in tables::by_pattern(evaluation, usize::MAX)
        .into_iter()
        .chain([tables::differences(evaluation)])
    {
        lines.extend([String::new(), table.caption.clone()]);
        lines.extend(table.lines());
        lines.extend(table.notes.iter().map(|note| format!("({note})")));
    }
    lines.push(format!("counts as the model: {}", counted::counted(scores)));
    lines.join("\n")
}
