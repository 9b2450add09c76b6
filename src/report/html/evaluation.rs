//! `evaluation.html`: the paper's tables of patterns × detectors, and the paired differences of AP@0.5.

use maud::{Markup, html};

use super::{notes, number, shell};
use crate::report::counted;
use crate::report::evaluation::{Evaluation, SCOPE, interval, is_shown};
use crate::score::{BASE_VARIANT, Difference, EvaluatedDetector, Figures};
use crate::spelling;

/// The whole page.
pub(in crate::report) fn render(evaluation: &Evaluation) -> String {
    let scores = evaluation.scores;
    let model = &scores.sessions[0].scene.model;
    let lead = format!(
        "{} and “{BASE_VARIANT}” on the 1:{} model of a {}, {}; AP@0.5: {}; counts as the model: {}.",
        spelling::count(evaluation.patterns.len().saturating_sub(1), "pattern"),
        model.scale,
        model.class,
        spelling::count(scores.photos.len(), "rendered photo"),
        scores.criteria.ap.name(),
        counted(scores)
    );
    let others = evaluation.others();
    let mut sections = vec![("table-1", "Table 1: AP@0.5 and mean confidence", table_1(evaluation))];
    if !others.is_empty() {
        sections.push((
            "table-2",
            "Table 2: transfer to other detectors",
            table_2(evaluation, &others),
        ));
    }
    sections.push(("differences", "Differences between patterns", differences(evaluation)));
    sections.push(("definitions", "Definitions", notes::definitions(scores)));
    let chance = evaluation.comparisons.first().map_or(String::new(), |c| {
        format!("{} bootstrap draws, seed {}", c.bootstrap_draws, c.bootstrap_seed)
    });
    sections.push(("provenance", "Provenance", notes::provenance(scores, &chance)));
    shell(scores, &lead, &sections, html! {})
}

fn table_1(evaluation: &Evaluation) -> Markup {
    let targets = evaluation.targets();
    html! {
        (notes::cautions(evaluation.scores))
        div.scroll {
            table {
                thead {
                    tr { th rowspan="2" { "pattern" } @for c in &targets { th colspan="3" { (c.manifest.title) } } }
                    tr { @for _ in &targets { th { "AP@0.5" } th.of { "drop" } th { "confidence" } } }
                }
                tbody {
                    @for pattern in &evaluation.patterns {
                        tr {
                            td { (pattern) }
                            @for c in &targets { (ap_cells(evaluation, pattern, c)) td { (figure(evaluation, pattern, c, |f| f.mean_confidence)) } }
                        }
                    }
                }
            }
        }
        p.note { "Drop: from " (BASE_VARIANT) ", bold when shown at 5 %. Confidence: mean, misses count 0. " (SCOPE) "." }
    }
}

fn table_2(evaluation: &Evaluation, others: &[&EvaluatedDetector]) -> Markup {
    html! {
        div.scroll {
            table {
                thead { tr { th { "pattern" } @for c in others { th { (c.manifest.title) } th.of { "drop" } } } }
                tbody {
                    @for pattern in &evaluation.patterns {
                        tr { td { (pattern) } @for c in others { (ap_cells(evaluation, pattern, c)) } }
                    }
                }
            }
        }
        p.note { "AP@0.5 of detectors that the patterns were not made against, and its drop from " (BASE_VARIANT) "." }
    }
}

/// AP@0.5 and its drop from the base.
fn ap_cells(evaluation: &Evaluation, pattern: &str, detector: &EvaluatedDetector) -> Markup {
    html! {
        td { (figure(evaluation, pattern, detector, |f| f.ap50)) }
        td.of { @if let Some(d) = evaluation.drop(BASE_VARIANT, pattern, detector) { (difference(d)) } }
    }
}

fn figure(evaluation: &Evaluation, pattern: &str, detector: &EvaluatedDetector, of: fn(&Figures) -> f64) -> String {
    let figures = evaluation.figures(pattern, detector);
    figures.map_or("–".to_owned(), |f| number(of(f), 2))
}

fn difference(d: &Difference) -> Markup {
    let text = interval(d).replace('-', "−");
    html! { @if is_shown(d) { b { (text) } } @else { (text) } }
}

/// For each detector, the AP@0.5 of the row's pattern minus that of the column's.
fn differences(evaluation: &Evaluation) -> Markup {
    let patterns = &evaluation.patterns;
    html! {
        @for c in evaluation.targets().iter().chain(&evaluation.others()) {
            h3 { (c.manifest.title) }
            div.scroll {
                table {
                    thead { tr { th { "AP@0.5 of … minus that of" } @for p in patterns.iter().skip(1) { th { (p) } } } }
                    tbody {
                        @for (i, base) in patterns.iter().enumerate().take(patterns.len().saturating_sub(1)) {
                            tr {
                                td { (base) }
                                @for (j, other) in patterns.iter().enumerate().skip(1) {
                                    td { @if j > i { @if let Some(d) = evaluation.drop(base, other, c) { (difference(d)) } } }
                                }
                            }
                        }
                    }
                }
            }
        }
        p.note { "Above 0, the detector does worse with the column's pattern; bold when shown at 5 %. " (SCOPE) "." }
    }
}
