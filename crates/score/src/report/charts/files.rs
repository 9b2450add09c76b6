//! Charts of the pages as SVG and PDF files for papers.

use crate::figures::{Comparison, Scores};
use crate::report::charts::{colours, curves, drops, heat, intervals, polar, reliability, robustness, speed};
use crate::report::words::certainty;
use crate::report::{ReportError, RunReport};
use scaleproof_plot::{Drawing, Explained, figure};

/// Name of the chart that a report has only when something is compared.
const DROPS: &str = "drop_of_confidence";

/// Name of the chart that a report has only when times are given.
const AGAINST_TIME: &str = "ap_against_time";

/// Name of the chart that a report has only when photos were corrupted.
const ROBUSTNESS: &str = "robustness";

pub(crate) type File = (String, Vec<u8>);

pub(crate) fn of_run(report: &RunReport) -> Result<Vec<File>, ReportError> {
    let (scores, findings, speeds) = (report.scores, report.findings, report.speeds);
    let textures = || colours::legend(scores);
    let (found, precision_recall): (Vec<_>, Vec<_>) = curves::charts(scores)
        .into_iter()
        .map(|(title, [found, precision_recall])| ((title, found), (title, precision_recall)))
        .unzip();
    let mut all = Vec::new();
    let mut add = |[name, title]: [&str; 2], legend, note: Option<&str>, across, drawings: Vec<(&str, Drawing)>| {
        let notes = note.into_iter().map(str::to_owned).collect();
        if !drawings.is_empty() {
            all.extend(files_of(name, title, &Explained { legend, notes }, across, drawings)?);
        }
        Ok::<(), ReportError>(())
    };
    if !findings.results.is_empty() {
        let chart = intervals::chart(findings);
        let title = "Drop of the mean confidence of each detector";
        let legend = intervals::legend(findings);
        add([DROPS, title], legend, Some(intervals::MARKS), 1, vec![("", chart)])?;
    }
    let polar = ["polar", "Mean confidence by azimuth"];
    add(polar, textures(), Some(polar::MARKS), 3, polar::charts(scores))?;
    let by_confidence = ["found_by_confidence", "Share of photos found by confidence"];
    add(by_confidence, textures(), None, 3, found)?;
    let over_recall = ["precision_recall", "Precision over recall"];
    add(over_recall, textures(), None, 3, precision_recall)?;
    let correct = ["reliability", "Share correct by confidence"];
    add(correct, Vec::new(), None, 3, reliability::charts(scores))?;
    let heat = ["heat_maps", "Mean confidence by viewing direction"];
    add(heat, heat::legend(), Some(heat::CELLS), 2, heat::charts(scores))?;
    if let Some(speeds) = speeds {
        let plot = vec![("", speed::plot(scores, speeds))];
        add([AGAINST_TIME, "AP against time"], textures(), None, 3, plot)?;
    }
    if let Some(robustness) = &scores.robustness {
        let charts = robustness::charts(scores, robustness);
        let (titles, drawings): (Vec<String>, Vec<_>) = charts.into_iter().unzip();
        let charts = titles.iter().map(String::as_str).zip(drawings).collect();
        let (note, across) = (Some(robustness::MARKS), robustness.corruptions().len());
        add(
            [ROBUSTNESS, "AP on photos made worse"],
            textures(),
            note,
            across,
            charts,
        )?;
    }
    Ok(all)
}

pub(crate) fn of_comparison(scores: &Scores, comparison: &Comparison) -> Result<Vec<File>, ReportError> {
    let drawings = drops::charts(scores, comparison);
    let explained = Explained {
        notes: vec![
            format!(
                "Dot: the figure of “{}” minus that of the texture; line: its 95 % interval. Filled: an effect is shown.",
                comparison.base
            ),
            format!(
                "Decided by the mean confidence, {}: sign flips by view, joint over the detectors.",
                certainty::family(&comparison.results)
            ),
        ],
        ..Explained::default()
    };
    files_of("drops", "Drops with 95 % intervals", &explained, 1, drawings)
}

/// Returns the names of chart files that an earlier report may have left and this one does not write.
pub(crate) fn stale(report: &RunReport, no_longer_robustness: bool) -> Vec<String> {
    let charts = [
        (DROPS, report.findings.results.is_empty()),
        (AGAINST_TIME, report.speeds.is_none()),
        (ROBUSTNESS, no_longer_robustness),
    ];
    let stale = charts.into_iter().filter(|(_, is_stale)| *is_stale);
    stale
        .flat_map(|(name, _)| ["svg", "pdf"].map(|ending| file_name(name, ending)))
        .collect()
}

/// Returns the file name of a chart. It lies in the page's own folder: only files of one folder appear together or not at all.
fn file_name(name: &str, ending: &str) -> String {
    format!("figure_{name}.{ending}")
}

fn files_of(
    name: &str,
    title: &str,
    explained: &Explained,
    across: usize,
    drawings: Vec<(&str, Drawing)>,
) -> Result<Vec<File>, ReportError> {
    let drawn = figure(title, explained, across, drawings);
    Ok(vec![
        (file_name(name, "svg"), drawn.svg().into_bytes()),
        (file_name(name, "pdf"), drawn.pdf()?),
    ])
}
