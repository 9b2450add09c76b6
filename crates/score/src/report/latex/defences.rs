//! `defences.tex`: differences between variants on defended photos.

use crate::figures::{Defences, Scores};
use crate::report::table::Table;
use crate::report::words::counted;

/// Returns both tables in TeX, below a comment that describes the defences.
pub(crate) fn tex(scores: &Scores, defences: &Defences, tables: &[Table; 2]) -> String {
    let cards = defences
        .defences
        .iter()
        .map(|d| format!("% {}: {} ({})", d.name, d.does, d.source));
    let cards: String = cards.map(|card| one_line(&card) + "\n").collect();
    let tables = tables
        .each_ref()
        .map(|table| format!("% {}.\n{}", one_line(&table.caption), table.tex()));
    let counted = one_line(&counted::counted(scores));
    format!(
        "% scaleproof {}. Needs \\usepackage{{booktabs}}. AP@0.5: {}. Counts as the model: {counted}.\n{cards}{}",
        env!("CARGO_PKG_VERSION"),
        scores.criteria.ap.name(),
        tables.join("\n")
    )
}

/// Replaces control characters by spaces, so that a text is one line of a comment.
fn one_line(text: &str) -> String {
    text.replace(char::is_control, " ")
}
