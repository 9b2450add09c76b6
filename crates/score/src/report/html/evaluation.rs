//! `evaluation.html`: the paper's tables of patterns × detectors, and the paired differences of AP@0.5.

use maud::html;

use crate::figures::BASE_VARIANT;
use crate::report::evaluation::Evaluation;
use crate::report::html::page::{ACROSS, Section, lead, shell};
use crate::report::html::{first, notes, patterns};
use crate::report::tables;
use crate::report::words::paper::Judged;
use scaleproof_core::spelling;

pub(crate) fn render(evaluation: &Evaluation) -> String {
    let scores = evaluation.scores;
    let against_base = evaluation.comparisons.iter().find(|c| c.base == BASE_VARIANT);
    let results = against_base.map_or(&[][..], |comparison| &comparison.results);
    let chance = evaluation.comparisons.first().map_or(String::new(), notes::bootstrap);
    let method = notes::method(scores, results, BASE_VARIANT, Judged::default());
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
    let library = first::library(scores, results, BASE_VARIANT, Vec::new());
    shell(
        scores,
        &lead,
        &first::screen(scores, results, BASE_VARIANT),
        &sections,
        library,
    )
}
