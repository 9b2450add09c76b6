//! `table.tex`: detector × texture.

use crate::figures::{Scores, disagreements};
use crate::report::latex::comments::{below, commented, comments};
use crate::report::{Findings, RunReport};

/// Returns the whole file: a comment that explains the numbers, and one `tabular`.
pub fn table(scores: &Scores) -> String {
    of_run(&RunReport::new(scores, None))
}

pub(crate) fn of_run(report: &RunReport) -> String {
    format!("{}\n{}", comment(report.findings), report.tables.figures.tex())
}

pub(crate) fn comment(findings: Findings) -> String {
    let scores = findings.scores;
    let criteria = &scores.criteria;
    let sign = if criteria.sign() == ">" { ">" } else { ">=" };
    let explained: String = comments(disagreements(scores).into_iter());
    let protocol = criteria.protocol.map(|p| format!(" Protocol: {}.", p.name()));
    format!(
        "% scaleproof {}. Needs \\usepackage{{booktabs}}. AP@0.5: {}.{}\n\
         % Hit: confidence {sign} {} and IoU {sign} {}; Wilson 95 % interval. Confidence: mean, misses count 0. Drop: {} minus texture,\n\
         % on pairs by place and bin, with its cluster bootstrap interval. Bold: an effect is shown;\n\
         % double dagger: no photos pair, over all photos. Counts as the model: {}.{explained}{}",
        env!("CARGO_PKG_VERSION"),
        criteria.ap.name(),
        protocol.unwrap_or_default(),
        criteria.hit_confidence,
        criteria.match_iou(),
        scores.base.replace(char::is_control, " "),
        commented(scores),
        below(findings),
    )
}
