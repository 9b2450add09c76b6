//! Files of a run's report.

use std::path::{Path, PathBuf};

use crate::figures::Scores;
use crate::report::error::ReportError;
use crate::report::json::coco;
use crate::report::json::summary::summary_json;
use crate::report::stale::{Before, DEFENCES, PROTOCOL, ROBUSTNESS, SUMMARY, remove_stale, results_name};
use crate::report::{charts, csv, html, latex, tables};
use scaleproof_core::files;
use scaleproof_detect::{Speeds, coco_results};

/// Writes every report file into a folder and returns the path of the page to open. Times of detectors come from a file, never
/// from a clock, so that the same input gives the same bytes.
///
/// All contents are made before the first byte is written, and the files appear together or not at all.
pub fn write(folder: &Path, scores: &Scores, speeds: Option<&Speeds>) -> Result<PathBuf, ReportError> {
    let mut contents = vec![
        (SUMMARY.to_owned(), summary_json(scores, speeds)?),
        ("photos.csv".to_owned(), csv::photos::render(scores)?),
        ("figures.csv".to_owned(), csv::figures::render(scores)?),
        ("coco_truth.json".to_owned(), coco::truth(scores)?),
        ("table.tex".to_owned(), latex::table(scores)),
        ("report.html".to_owned(), html::render(scores, speeds)),
    ];
    if let Some(table) = tables::protocol(scores) {
        let [csv, tex] = PROTOCOL.map(str::to_owned);
        contents.extend([(csv, table.csv()?), (tex, latex::protocol::protocol(&table))]);
    }
    if let Some(defences) = &scores.defences {
        let [csv, tex] = DEFENCES.map(str::to_owned);
        contents.extend([
            (csv, csv::defences::csv(scores, defences)?),
            (tex, latex::defences::tex(scores, defences)),
        ]);
    }
    if let Some(robustness) = &scores.robustness {
        contents.push((ROBUSTNESS.to_owned(), csv::robustness::csv(scores, robustness)?));
    }
    let categories = coco::Categories::from_scores(scores);
    for (index, detector) in scores.detectors.iter().enumerate() {
        let photos = scores.photos.iter().map(|p| (p.id, p.detections[index].as_slice()));
        let results = coco_results(photos, |label| categories.id(detector, label))?;
        contents.push((results_name(&detector.manifest.name), results));
    }
    let figures = charts::files::of_report(scores, speeds)?;
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
