//! `evaluation.html`: the paper's tables of patterns × detectors, and the paired differences of AP@0.5.

use maud::{Markup, html};

use super::{ACROSS, notes, number, patterns, shell, table};
use crate::report::evaluation::{Evaluation, SCOPE};
use crate::report::{counted, paired};
use crate::score::{BASE_VARIANT, Compared, Effect, EvaluatedDetector, Figures};
use scaleproof_core::spelling;

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
    let looks = patterns::strips(scores, &evaluation.patterns);
    let chance = evaluation.comparisons.first().map_or(String::new(), notes::bootstrap);
    let transfer = (!others.is_empty()).then(|| table_2(evaluation, &others));
    let sections = [
        ("patterns", "Patterns", Some(looks)),
        (
            "table-1",
            "Table 1: AP@0.5 and mean confidence",
            Some(table_1(evaluation)),
        ),
        ("table-2", "Table 2: transfer to other detectors", transfer),
        (
            "differences",
            "Differences between patterns",
            Some(differences(evaluation)),
        ),
        ("definitions", "Definitions", Some(notes::definitions(scores))),
        ("provenance", "Provenance", Some(notes::provenance(scores, &chance))),
    ];
    shell(scores, &lead, &sections, html! {})
}

fn table_1(evaluation: &Evaluation) -> Markup {
    html! {
        (notes::cautions(evaluation.scores))
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
