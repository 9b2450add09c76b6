//! The charts as files for papers, SVG and PDF, of the marks that the pages show.

use super::{ReportError, certainty, html};
use crate::detect::Speeds;
use crate::plot::{Drawing, Explained, figure};
use crate::print::figure::pdf_of_svg;
use crate::score::{Comparison, Scores};
use crate::spelling;

/// The chart that a report has only when times are given.
const AGAINST_TIME: &str = "ap_against_time";

/// A file's name and content.
pub(super) type File = (String, Vec<u8>);

/// The charts of a report.
pub(super) fn of_report(scores: &Scores, speeds: Option<&Speeds>) -> Result<Vec<File>, ReportError> {
    let textures = html::legend(scores);
    let (found, precision_recall): (Vec<_>, Vec<_>) = html::curves::charts(scores)
        .into_iter()
        .map(|(title, [found, precision_recall])| ((title, found), (title, precision_recall)))
        .unzip();
    let mut all = vec![
        (
            "polar",
            "Mean confidence by azimuth",
            textures.clone(),
            html::polar::charts(scores),
        ),
        (
            "found_by_confidence",
            "Share of photos found by confidence",
            textures.clone(),
            found,
        ),
        (
            "precision_recall",
            "Precision over recall",
            textures.clone(),
            precision_recall,
        ),
        (
            "reliability",
            "Share correct by confidence",
            Vec::new(),
            html::reliability::charts(scores),
        ),
        (
            "heat_maps",
            "Mean confidence by viewing direction",
            html::heat::legend(),
            html::heat::charts(scores),
        ),
    ];
    if let Some(speeds) = speeds {
        all.push((
            AGAINST_TIME,
            "AP against time",
            textures,
            vec![("", html::speed::plot(scores, speeds))],
        ));
    }
    let files = all.into_iter().filter(|(.., drawings)| !drawings.is_empty());
    let files = files.map(|(name, title, legend, drawings)| {
        let notes = match name {
            "polar" => vec![html::polar::MARKS.to_owned()],
            "heat_maps" => vec![html::heat::CELLS.to_owned()],
            _ => Vec::new(),
        };
        let across = if name == "heat_maps" { 2 } else { 3 };
        files_of(name, title, &Explained { legend, notes }, across, &drawings)
    });
    Ok(files.collect::<Result<Vec<_>, _>>()?.concat())
}

/// The drops of a comparison, one chart for each figure.
pub(super) fn of_comparison(scores: &Scores, comparison: &Comparison) -> Result<Vec<File>, ReportError> {
    let drawings = html::comparison::charts(scores, comparison);
    let explained = Explained {
        notes: vec![
            format!(
                "Dot: the figure of “{}” minus that of the texture; line: its 95 % interval. Filled: a difference is shown at 5 %.",
                comparison.base
            ),
            format!(
                "{} are tested at 5 % each, without correction for their number; behind McNemar's p that by Holm over the detectors.",
                spelling::count(certainty::FIGURES * comparison.results.len(), "finding")
            ),
        ],
        ..Explained::default()
    };
    files_of("drops", "Drops with 95 % intervals", &explained, 1, &drawings)
}

/// What an earlier report may have left that this one does not write.
pub(super) fn stale(speeds: Option<&Speeds>) -> Vec<String> {
    match speeds {
        Some(_) => Vec::new(),
        None => ["svg", "pdf"].map(|ending| file_name(AGAINST_TIME, ending)).to_vec(),
    }
}

/// In the page's own folder: only files of one folder appear together or not at all.
fn file_name(name: &str, ending: &str) -> String {
    format!("figure_{name}.{ending}")
}

fn files_of(
    name: &str,
    title: &str,
    explained: &Explained,
    across: usize,
    drawings: &[(&str, Drawing)],
) -> Result<Vec<File>, ReportError> {
    let svg = figure(title, explained, across, drawings);
    let pdf = pdf_of_svg(title, &svg)?;
    Ok(vec![
        (file_name(name, "svg"), svg.into_bytes()),
        (file_name(name, "pdf"), pdf),
    ])
}
