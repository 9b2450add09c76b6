//! `evaluation.html`: the paper's tables of patterns × detectors, and the paired differences of AP@0.5.

use maud::{Markup, html};

use super::{ACROSS, Section, first, lead, notes, patterns, shell, table};
use crate::report::evaluation::{Evaluation, SCOPE};
use crate::report::{number, paired};
use crate::score::{BASE_VARIANT, Compared, Effect, EvaluatedDetector, Figures};
use scaleproof_core::spelling;

pub(in crate::report) fn render(evaluation: &Evaluation) -> String {
    let scores = evaluation.scores;
    let against_base = evaluation.comparisons.iter().find(|c| c.base == BASE_VARIANT);
    let results = against_base.map_or(&[][..], |comparison| &comparison.results);
    let others = evaluation.others();
    let chance = evaluation.comparisons.first().map_or(String::new(), notes::bootstrap);
    let method = notes::method(scores, results, BASE_VARIANT, None);
    let mut sections = vec![Section::open(
        "table-1",
        "Table 1: AP@0.5 and mean confidence",
        table_1(evaluation),
    )];
    if !others.is_empty() {
        sections.push(Section::open(
            "table-2",
            "Table 2: transfer to other detectors",
            table_2(evaluation, &others),
        ));
    }
    sections.extend([
        Section::open("patterns", "Patterns", patterns::strips(scores, &evaluation.patterns)),
        Section::folded("differences", "Differences between patterns", differences(evaluation)),
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

fn table_1(evaluation: &Evaluation) -> Markup {
    html! {
        (by_detector(evaluation, &evaluation.targets(), |f| format!("{} / {}", number(f.ap50, 2), number(f.mean_confidence, 2))))
        p.note {
            "AP@0.5 / mean confidence (misses count 0); below, the drop of AP@0.5 from " (BASE_VARIANT) ", red when it is shown after correction. " (SCOPE) "."
        }
    }
}

fn table_2(evaluation: &Evaluation, others: &[&EvaluatedDetector]) -> Markup {
    html! {
        (by_detector(evaluation, others, |f| number(f.ap50, 2)))
        p.note { "AP@0.5 of detectors that the patterns were not made against; below, its drop from " (BASE_VARIANT) "." }
    }
}

/// A row for each pattern and a column for each detector, several tables where there are many detectors.
fn by_detector(evaluation: &Evaluation, detectors: &[&EvaluatedDetector], cell: fn(&Figures) -> String) -> Markup {
    html! {
        @for some in detectors.chunks(ACROSS) {
            @let head = html! { th { "pattern" } @for c in some { th { (c.manifest.title) } } };
            @let rows = html! {
                @for pattern in &evaluation.patterns {
                    tr {
                        td { (pattern) }
                        @for c in some {
                            td {
                                (evaluation.figures(pattern, c).map_or("–".to_owned(), cell))
                                @if let Some(r) = evaluation.compared(BASE_VARIANT, pattern, c) { br; small { "drop " } (difference(r)) }
                            }
                        }
                    }
                }
            };
            (table(Some("cells"), &head, &rows))
        }
    }
}

/// The difference of AP, its interval, and the effect where one was asked for. Red where the texture is shown to weaken the detector.
fn difference(r: &Compared) -> Markup {
    let is_weaker = matches!(r.effect(), Effect::Hides | Effect::Weakens);
    html! {
        span.down[is_weaker] { (number(r.ap50.drop, 2)) }
        small {
            @if let Some(interval) = paired::interval(&r.ap50, |v| number(v, 2)) { " " (interval) }
            @if let Some(finding) = r.finding { br; (paired::briefly(finding.effect)) }
        }
    }
}

/// For each detector, the AP@0.5 of the row's pattern minus that of the column's.
fn differences(evaluation: &Evaluation) -> Markup {
    let (rows, columns) = (&evaluation.patterns, evaluation.patterns.get(1..).unwrap_or_default());
    html! {
        @for c in evaluation.targets().iter().chain(&evaluation.others()) {
            h3 { (c.manifest.title) }
            @for some in columns.chunks(ACROSS) {
                @let head = html! { th { "AP@0.5 of … minus that of" } @for p in some { th { (p) } } };
                @let rows = html! {
                    @for base in rows.iter().take(columns.len()) {
                        tr {
                            td { (base) }
                            @for other in some { td { @if let Some(r) = evaluation.compared(base, other, c) { (difference(r)) } } }
                        }
                    }
                };
                (table(Some("cells"), &head, &rows))
            }
        }
        p.note { "Above 0, the detector does worse with the column's pattern; red when the pattern is shown to weaken it, which is asked against the plain model alone. " (SCOPE) "." }
    }
}
