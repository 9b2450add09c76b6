//! Files of a comparison.

use std::path::{Path, PathBuf};

use crate::figures::{Comparison, Scores};
use crate::report::html::comparison as page;
use crate::report::json::comparison::comparison_json;
use crate::report::{ReportError, charts, csv, latex};
use scaleproof_core::files;

/// Writes every file of a comparison into a folder, or none, and returns the path of the page to open.
pub fn write_comparison(folder: &Path, scores: &Scores, comparison: &Comparison) -> Result<PathBuf, ReportError> {
    let texts = [
        ("comparison.html", page::render(scores, comparison)),
        ("comparison.tex", latex::comparison::comparison(scores, comparison)),
        ("comparison.csv", csv::comparison::render(scores, comparison)?),
        ("comparison.json", comparison_json(scores, comparison)?),
    ];
    let mut all = texts
        .map(|(name, text)| (folder.join(name), text.into_bytes()))
        .to_vec();
    let figures = charts::files::of_comparison(scores, comparison)?;
    all.extend(figures.into_iter().map(|(name, content)| (folder.join(name), content)));
    files::replace_all_atomically(folder, &all)?;
    Ok(folder.join("comparison.html"))
}
