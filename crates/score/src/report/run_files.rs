//! Files of a run's report.

use std::path::{Path, PathBuf};

use crate::figures::Scores;
use crate::report::json::coco;
use crate::report::stale::{DEFENCES, EarlierReport, PROTOCOL, ROBUSTNESS, SUMMARY, remove_stale, results_name};
use crate::report::{ReportError, RunReport, charts, csv, html, json, latex};
use scaleproof_core::files;
use scaleproof_detect::{Speeds, coco_results};

/// Writes every report file into a folder and returns the path of the page to open. Times of detectors come from a file, never
/// from a clock, so that the same input gives the same bytes.
///
/// All contents are made before the first byte is written, and the files appear together or not at all.
pub fn write(folder: &Path, scores: &Scores, speeds: Option<&Speeds>) -> Result<PathBuf, ReportError> {
    let report = RunReport::new(scores, speeds);
    let mut contents = vec![
        (SUMMARY.to_owned(), json::summary::summary(&report)?),
        ("photos.csv".to_owned(), csv::photos::render(scores)?),
        ("figures.csv".to_owned(), csv::figures::render(scores)?),
        ("coco_truth.json".to_owned(), coco::truth(scores)?),
        ("table.tex".to_owned(), latex::run::of_run(&report)),
        ("report.html".to_owned(), html::run::of_run(&report)),
    ];
    if let Some(table) = &report.tables.protocol {
        let [csv, tex] = PROTOCOL.map(str::to_owned);
        contents.extend([(csv, table.csv()?), (tex, latex::protocol::protocol(table))]);
    }
    if let Some((defences, tables)) = scores.defences.as_ref().zip(report.tables.defended.as_ref()) {
        let [csv, tex] = DEFENCES.map(str::to_owned);
        contents.extend([
            (csv, csv::robustness::defences(scores, defences)?),
            (tex, latex::defences::tex(scores, defences, tables)),
        ]);
    }
    if let Some(robustness) = &scores.robustness {
        contents.push((ROBUSTNESS.to_owned(), csv::robustness::robustness(scores, robustness)?));
    }
    let categories = coco::Categories::from_scores(scores);
    for (index, detector) in scores.detectors.iter().enumerate() {
        let photos = scores.photos.iter().map(|p| (p.id, p.detections[index].as_slice()));
        let results = coco_results(photos, |label| categories.id(detector, label))?;
        contents.push((results_name(&detector.manifest.name), results));
    }
    let figures = charts::files::of_run(&report)?;
    let contents = contents
        .into_iter()
        .map(|(name, text)| (name, text.into_bytes()))
        .chain(figures);
    let files: Vec<_> = contents.map(|(name, content)| (folder.join(name), content)).collect();
    let before = EarlierReport::in_folder(folder);
    files::replace_all_atomically(folder, &files)?;
    remove_stale(folder, &before, &report)?;
    Ok(folder.join("report.html"))
}
