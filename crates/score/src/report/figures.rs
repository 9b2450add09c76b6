//! The charts as files for papers, SVG and PDF, of the marks that the pages show.

use super::{ReportError, certainty, html};
use crate::score::{Comparison, Scores};
use scaleproof_core::spelling;
use scaleproof_detect::Speeds;
use scaleproof_plot::chart_pdf::pdf_of_svg;
use scaleproof_plot::{Drawing, Explained, figure};

/// The chart that a report has only when times are given.
const AGAINST_TIME: &str = "ap_against_time";

/// The chart that a report has only when photos were made worse.
const ROBUSTNESS: &str = "robustness";

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
    let robustness = scores.robustness.as_ref().map(|r| html::robustness::charts(scores, r));
    let (titles, drawings): (Vec<String>, Vec<_>) = robustness.into_iter().flatten().unzip();
    all.push((
        ROBUSTNESS,
        "AP on photos made worse",
        html::legend(scores),
        titles.iter().map(String::as_str).zip(drawings).collect(),
    ));
    let files = all.into_iter().filter(|(.., drawings)| !drawings.is_empty());
    let files = files.map(|(name, title, legend, drawings)| {
        let notes = match name {
            "polar" => vec![html::polar::MARKS.to_owned()],
            "heat_maps" => vec![html::heat::CELLS.to_owned()],
            ROBUSTNESS => vec![html::robustness::MARKS.to_owned()],
            _ => Vec::new(),
        };
        let across = match name {
            "heat_maps" => 2,
            ROBUSTNESS => scores.robustness.as_ref().map_or(3, |r| r.corruptions().len()),
            _ => 3,
        };
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
pub(super) fn stale(speeds: Option<&Speeds>, no_longer_robustness: bool) -> Vec<String> {
    let charts = [(AGAINST_TIME, speeds.is_none()), (ROBUSTNESS, no_longer_robustness)];
    let stale = charts.into_iter().filter(|(_, is_stale)| *is_stale);
    stale
        .flat_map(|(name, _)| ["svg", "pdf"].map(|ending| file_name(name, ending)))
        .collect()
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
