//! `protocol.tex`: the table of a run's protocol.

use crate::report::table::Table;

/// Returns the table below a comment.
pub(crate) fn protocol(table: &Table) -> String {
    format!(
        "% scaleproof {}. Needs \\usepackage{{booktabs}}.\n% {}.\n{}",
        env!("CARGO_PKG_VERSION"),
        table.caption.replace(char::is_control, " "),
        table.tex()
    )
}
