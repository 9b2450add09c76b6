//! Files of an evaluation: its page, tables for a paper, and CSV for spreadsheets.

use std::path::{Path, PathBuf};

use crate::report::csv::evaluation::{differences_csv, figures_csv};
use crate::report::html::evaluation as page;
use crate::report::{Evaluation, ReportError, latex};
use scaleproof_core::files;

/// Writes every file of an evaluation into a folder, or none, and returns the path of the page to open.
pub fn write_evaluation(folder: &Path, evaluation: &Evaluation) -> Result<PathBuf, ReportError> {
    let texts = [
        ("evaluation.html", page::render(evaluation)),
        ("evaluation.csv", figures_csv(evaluation)?),
        ("differences.csv", differences_csv(evaluation)?),
        ("evaluation.tex", latex::evaluation::evaluation(evaluation)),
    ];
    files::replace_all_atomically(
        folder,
        &texts.map(|(name, text)| (folder.join(name), text.into_bytes())),
    )?;
    Ok(folder.join("evaluation.html"))
}
