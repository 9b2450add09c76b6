//! The table of a run's protocol as files: `protocol.csv` and `protocol.tex`.

use crate::figures::Scores;
use crate::report::{ReportError, tables};

/// Returns names and contents of the files; none when the run follows no protocol.
pub(super) fn files(scores: &Scores) -> Result<Vec<(String, String)>, ReportError> {
    let Some(table) = tables::protocol(scores) else {
        return Ok(Vec::new());
    };
    let tex = format!(
        "% scaleproof {}. Needs \\usepackage{{booktabs}}.\n% {}.\n{}",
        env!("CARGO_PKG_VERSION"),
        table.caption.replace(char::is_control, " "),
        table.tex()
    );
    Ok(vec![(NAMES[0].to_owned(), table.csv()?), (NAMES[1].to_owned(), tex)])
}

pub(super) const NAMES: [&str; 2] = ["protocol.csv", "protocol.tex"];
