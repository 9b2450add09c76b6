//! Report files of scores, for people and programs: HTML, LaTeX, JSON, CSV, COCO.

mod certainty;
mod coco;
mod comparison;
mod comparison_csv;
mod counted;
mod csv;
mod defences;
mod evaluation;
mod evaluation_files;
mod evaluation_screen;
mod export;
mod figures;
mod figures_csv;
pub mod html;
pub mod latex;
mod paired;
mod paper;
mod protocol;
mod provenance;
mod robustness;
mod screen;
mod sequential;
pub mod shade;
mod summary_json;
mod table;
mod tables;
pub mod tex;
mod truth;
mod verdict;

use std::path::{Path, PathBuf};

use serde::Deserialize;
use serde_json::Value;

use crate::evaluated::EvaluatedDetector;
use crate::figures::{ScoredPhoto, Scores};
use scaleproof_core::files;
use scaleproof_core::spelling::digits;
use scaleproof_detect::{Manifest, Speeds, coco_results};
use scaleproof_plot::pdf::PdfError;

pub use crate::report::comparison::{
    ComparisonPage, comparison_json, comparison_table, further_comparison, write_comparison,
};
pub use crate::report::comparison_csv::render as comparison_csv;
pub use crate::report::counted::{box_labels, counted};
pub use crate::report::csv::render as photos_csv;
pub use crate::report::evaluation::Evaluation;
pub use crate::report::evaluation_files::write_evaluation;
pub use crate::report::evaluation_screen::evaluation_tables;
pub use crate::report::export::{ExportFormat, check_export, export};
pub use crate::report::figures_csv::render as figures_csv;
pub use crate::report::html::comparison::render as comparison_html;
pub use crate::report::paired::briefly;
pub use crate::report::screen::{further_tables, summary_table};
pub use crate::report::sequential::standing;
pub use crate::report::summary_json::{SummaryPage, summary_json};
pub use crate::report::table::cell::{Cell, Value as CellValue};
pub use crate::report::table::{Column, Side, Table};
pub use crate::report::truth::truth_boxes;

const SUMMARY: &str = "summary.json";

/// Reason why the report could not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    #[error(transparent)]
    File(#[from] files::FileError),
    #[error("the report could not be put together: {0}")]
    Json(#[from] serde_json::Error),
    #[error("the report could not be put together: {0}")]
    Csv(#[from] ::csv::Error),
    #[error(transparent)]
    Figure(#[from] PdfError),
}

/// A line of a table for spreadsheets: each column's name and value.
type Row<'a> = Vec<(&'a str, Value)>;

/// Writes a table with a header, for spreadsheets; a value that is null is left empty.
fn csv_of<N: AsRef<str>>(rows: impl IntoIterator<Item = Vec<(N, Value)>>) -> Result<String, ReportError> {
    let mut writer = ::csv::Writer::from_writer(Vec::new());
    for (i, row) in rows.into_iter().enumerate() {
        let (names, values): (Vec<N>, Vec<Value>) = row.into_iter().unzip();
        if i == 0 {
            writer.write_record(names.iter().map(AsRef::as_ref))?;
        }
        writer.serialize(values)?;
    }
    let text = writer.into_inner().map_err(|e| ::csv::Error::from(e.into_error()))?;
    // All values were valid UTF-8: nothing is lost.
    Ok(String::from_utf8_lossy(&text).into_owned())
}

/// Writes every report file into a folder and returns the path of the page to open. Times of detectors come from a file, never
/// from a clock, so that the same input gives the same bytes.
///
/// All contents are made before the first byte is written, and the files appear together or not at all.
pub fn write(folder: &Path, scores: &Scores, speeds: Option<&Speeds>) -> Result<PathBuf, ReportError> {
    let mut contents = vec![
        (SUMMARY.to_owned(), summary_json(scores, speeds)?),
        ("photos.csv".to_owned(), csv::render(scores)?),
        ("figures.csv".to_owned(), figures_csv::render(scores)?),
        ("coco_truth.json".to_owned(), coco::truth(scores)?),
        ("table.tex".to_owned(), latex::table(scores)),
        ("report.html".to_owned(), html::render(scores, speeds)),
    ];
    contents.extend(protocol::files(scores)?);
    contents.extend(defences::files(scores)?);
    if let Some(robustness) = &scores.robustness {
        contents.push((robustness::NAME.to_owned(), robustness::csv(scores, robustness)?));
    }
    let categories = coco::Categories::from_scores(scores);
    for (index, detector) in scores.detectors.iter().enumerate() {
        let photos = scores.photos.iter().map(|p| (p.id, p.detections[index].as_slice()));
        let results = coco_results(photos, |label| categories.id(detector, label))?;
        contents.push((results_name(&detector.manifest.name), results));
    }
    let figures = figures::of_report(scores, speeds)?;
    let contents = contents
        .into_iter()
        .map(|(name, text)| (name, text.into_bytes()))
        .chain(figures);
    let files: Vec<_> = contents.map(|(name, content)| (folder.join(name), content)).collect();
    let before = Before::in_folder(folder);
    files::replace_all_atomically(folder, &files)?;
    remove_stale(folder, &before, scores, speeds)?;
    Ok(folder.join("report.html"))
}

/// Contents of an earlier report in the folder that this one may not have.
#[derive(Deserialize, Default)]
struct Before {
    results: Vec<Reported>,
    #[serde(default)]
    protocol: Option<serde::de::IgnoredAny>,
    #[serde(default)]
    robustness: Option<serde::de::IgnoredAny>,
    #[serde(default)]
    defences: Option<serde::de::IgnoredAny>,
}

#[derive(Deserialize)]
struct Reported {
    detector: String,
}

impl Before {
    fn in_folder(folder: &Path) -> Before {
        let summary = folder.join(SUMMARY);
        files::inputs::own(&summary);
        let text = files::read_text(&summary).unwrap_or_default();
        serde_json::from_str(&text).unwrap_or_default()
    }
}

/// Removes files that an earlier run left and this one does not write: COCO results of other detectors, whose ids mean other photos now, and the
/// tables and charts of a protocol, of times, of corruptions and of defences that this run does not have.
fn remove_stale(folder: &Path, before: &Before, scores: &Scores, speeds: Option<&Speeds>) -> Result<(), ReportError> {
    let no_longer_robustness = before.robustness.is_some() && scores.robustness.is_none();
    let mut stale = figures::stale(scores, speeds, no_longer_robustness);
    if no_longer_robustness {
        stale.push(robustness::NAME.to_owned());
    }
    if before.defences.is_some() && scores.defences.is_none() {
        stale.extend(defences::NAMES.map(str::to_owned));
    }
    if before.protocol.is_some() && scores.criteria.protocol.is_none() {
        stale.extend(protocol::NAMES.map(str::to_owned));
    }
    let built_in = Manifest::all()
        .unwrap_or_default()
        .into_iter()
        .map(|manifest| manifest.name);
    // The summary may be somebody else's: only valid names of detectors become part of a path.
    let names = before.results.iter().map(|result| result.detector.clone());
    let names = built_in.chain(names.filter(|name| Manifest::is_name(name)));
    let others = names.filter(|name| scores.detectors.iter().all(|c| c.manifest.name != *name));
    stale.extend(others.map(|name| results_name(&name)));
    Ok(stale
        .iter()
        .try_for_each(|name| files::chosen::remove(folder, &folder.join(name)))?)
}

fn results_name(detector: &str) -> String {
    format!("coco_results_{detector}.json")
}

/// Formats a number with `behind` digits behind the point, and a true minus sign.
pub fn number(value: f64, behind: usize) -> String {
    digits(value, behind).replace('-', "−")
}

/// Formats a p value with its sign, to stand behind `p`.
pub fn p_value(p: f64) -> String {
    match digits(p, 3) {
        _ if p < 0.001 => "< 0.001".to_owned(),
        // Rounded to 0.050 it would look like a difference that is shown.
        shown if shown == "0.050" && p > 0.05 => "> 0.050".to_owned(),
        shown => format!("= {shown}"),
    }
}

/// Returns the name of another label on the model, with its confidence.
fn other_label(photo: &ScoredPhoto, index: usize, detector: &EvaluatedDetector) -> Option<(&'static str, f64)> {
    let (label, confidence) = photo.outcomes[index].other?;
    Some((detector.labels().name(label).unwrap_or("?"), confidence))
}
