//! `evaluation.html`: the paper's tables of patterns × detectors, and the paired differences of AP@0.5.

use maud::html;

use crate::report::html::page::{Section, lead, shell};
use crate::report::html::{first, notes, patterns};
use crate::report::tables::{self, ACROSS};
use crate::report::{Evaluation, Findings};
use scaleproof_core::spelling;

pub(crate) fn render(evaluation: &Evaluation) -> String {
    let scores = evaluation.scores;
    let findings = Findings::of_evaluation(evaluation);
    let main = if findings.results.is_empty() {
        tables::figures_of_screen(scores)
    } else {
        tables::effects(findings)
    };
    let chance = evaluation.comparisons.first().map_or(String::new(), notes::bootstrap);
    let method = notes::method(findings);
    let tables = tables::by_pattern(evaluation, ACROSS).into_iter();
    let tables = html! { @for table in tables { h3 { (table.caption) } (table.markup()) } };
    let mut sections = vec![Section::open("tables", "Tables of DTA's paper", tables)];
    sections.extend([
        Section::open("patterns", "Patterns", patterns::strips(scores, &evaluation.patterns)),
        Section::folded(
            "differences",
            "Differences between patterns",
            tables::differences(evaluation).markup(),
        ),
        Section::folded("method", "How this was decided, and what to write", method),
        Section::folded("definitions", "Definitions", notes::definitions(scores)),
        Section::folded("provenance", "Provenance", notes::provenance(scores, &chance)),
    ]);
    let lead = format!(
        "{} · {}",
        lead(scores),
        spelling::count(evaluation.patterns.len().saturating_sub(1), "pattern")
    );
    let library = first::library(findings, Vec::new());
    shell(scores, &lead, &first::screen(findings, &main), &sections, library)
}
