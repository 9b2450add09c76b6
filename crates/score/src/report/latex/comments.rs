//! Comments of a TeX file.

use crate::figures::{Difference, Scores};
use crate::report::Findings;
use crate::report::words::{certainty, counted};

/// Returns the comment below the notes of a table, a line each: how effects were decided, rates without an interval, and every caution.
pub(crate) fn below(findings: Findings) -> String {
    let scores = findings.scores;
    let open = findings.results.iter().flat_map(|r| {
        let figures = [("hit rate", &r.hit_rate.rate), ("AP@0.5", &r.ap50)];
        let is_open = |d: &Difference| d.asr.is_some() && d.asr_interval_95.is_none();
        let open = figures.into_iter().filter(move |(_, d)| is_open(d));
        open.map(|(name, d)| {
            let (title, why) = (scores.title(&r.detector), certainty::without_interval(r, d));
            format!("ASR of the {name}, {title} on {}: {why}", r.variant)
        })
    });
    let cautions = scores.cautions.iter().map(|caution| format!("Note: {caution}"));
    comments(certainty::tested(findings).into_iter().chain(open).chain(cautions))
}

pub(crate) fn comments(sentences: impl Iterator<Item = String>) -> String {
    let lines = sentences.map(|sentence| format!("\n% {}.", sentence.replace(char::is_control, " ")));
    lines.collect()
}

/// Returns the labels that count as the model, as one line of a comment.
pub(crate) fn commented(scores: &Scores) -> String {
    counted::counted(scores).replace(char::is_control, " ")
}
