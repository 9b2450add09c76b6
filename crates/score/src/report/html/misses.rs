//! What became of the model where it was not found, and how far a pattern's effect carries over to other detectors.

use std::collections::BTreeMap;

use maud::{Markup, html};

use super::shade::{ink, shade};
use super::{ACROSS, heads, number, rows_by_detector, table, title_of};
use crate::report::{counted, other_label, paired};
use crate::score::{Figures, ScoredPhoto, Scores, Summary, TransferDrop, TransferRow, transfer};

/// A bar of all photos for each detector and texture: hits, misclassified, disappeared.
pub(super) fn outcomes(scores: &Scores) -> Markup {
    let head = html! {
        (heads("detector", &["texture", "photos"])) th { "halluci\u{ad}nations" br; small { "a photo" } }
    };
    let cells =
        |s: &Summary| html! { td.bar { (bar(&s.overall)) } td { (number(s.overall.hallucinations_per_image, 2)) } };
    let criteria = &scores.criteria;
    let confidence = format!("confidence {} {}", criteria.sign(), criteria.hit_confidence);
    html! {
        ul.legend {
            li { i.hit {} "hit" }
            li { i.misclassified {} "misclassified: only another class on the model at " (confidence) }
            li { i.disappeared {} "disappeared: no detection of any class on the model at " (confidence) "; a weaker one does not count" }
        }
        (table(Some("outcomes"), &head, &rows_by_detector(scores, title_of, cells)))
    }
}

fn bar(f: &Figures) -> Markup {
    let parts = [
        ("hit", f.hit_rate),
        ("misclassified", f.misclassification_rate),
        ("disappeared", f.disappearance_rate),
    ];
    html! {
        div.bar {
            @for (class, rate) in parts {
                @if rate.count > 0 {
                    i class=(class) style=(format!("flex-grow:{}", rate.count))
                        title=(format!("{class}: {} of {}, [{}, {}]", rate.count, f.photos, number(rate.low, 2), number(rate.high, 2))) {
                        b { (rate.count) }
                    }
                }
            }
        }
    }
}

/// As what each detector took the model: photos by the label of its most confident detection on the model, which the matching one is for a hit.
pub(super) fn confusion(scores: &Scores) -> Markup {
    let taken = |index: usize, p: &ScoredPhoto| -> String {
        let (detector, outcome) = (&scores.detectors[index], &p.outcomes[index]);
        let own = p.detections[index].iter().find(|d| {
            detector.counts(d)
                && d.score >= scores.criteria.hit_confidence
                && d.box_px.iou(&p.truth) >= scores.criteria.match_iou()
        });
        let hit = own
            .filter(|_| outcome.is_hit())
            .and_then(|d| detector.labels().name(d.label));
        let other = || other_label(p, index, detector).map(|(label, _)| label);
        hit.or_else(other).unwrap_or(NOTHING).to_owned()
    };
    let mut counts: BTreeMap<(usize, &str), BTreeMap<String, usize>> = BTreeMap::new();
    for p in &scores.photos {
        for index in 0..scores.detectors.len() {
            *counts
                .entry((index, p.variant.as_str()))
                .or_default()
                .entry(taken(index, p))
                .or_default() += 1;
        }
    }
    let mut labels: BTreeMap<&str, usize> = BTreeMap::new();
    counts
        .values()
        .flatten()
        .for_each(|(label, count)| *labels.entry(label).or_default() += count);
    // What the model is comes first, nothing last, and between them what it was most often taken for.
    let counted = counted::classes(scores).labels();
    let mut labels: Vec<(&str, usize)> = labels.into_iter().collect();
    labels.sort_by_key(|(label, count)| {
        (
            *label == NOTHING,
            !counted.iter().any(|own| own == label),
            std::cmp::Reverse(*count),
            *label,
        )
    });
    let head = html! { (heads("detector", &["texture"])) @for (label, _) in &labels { th { (label) } } };
    let rows = html! {
        @for (index, c) in scores.detectors.iter().enumerate() {
            @for (i, variant) in scores.variants().into_iter().enumerate() {
                @if let Some(own) = counts.get(&(index, variant)) {
                    tr.first[i == 0] {
                        td { @if i == 0 { (title_of(c)) } } td.text { (variant) }
                        @for (label, _) in &labels { td { @match own.get(*label) { Some(count) => (count), None => "·" } } }
                    }
                }
            }
        }
    };
    html! {
        h3 { "As what the model was taken" }
        (table(Some("confusion"), &head, &rows))
        p.note { "Photos by the label on the model at hit confidence: of a hit the one that counts, else the most confident other." }
    }
}

/// No label at all.
const NOTHING: &str = "nothing";

/// Pattern × detector: the drop of AP and, below it, of the hit rate. Nothing without a base to drop from.
pub(super) fn transfer_matrix(scores: &Scores) -> Markup {
    let rows = transfer(&scores.summaries);
    html! {
        @if !rows.is_empty() {
            h3 { "Transfer: drop from " (scores.base) ", pattern × detector" }
            @for (i, some) in scores.detectors.chunks(ACROSS).enumerate() {
                @let head = html! { th { "pattern" } @for c in some { th { (c.manifest.title) } } };
                @let cells = |row: &TransferRow| html! {
                    @for cell in row.detectors.iter().skip(i * ACROSS).take(ACROSS) { (transfer_cell(scores, row, cell)) }
                };
                @let rows = html! { @for row in &rows { tr { td { (row.variant) } (cells(row)) } } };
                (table(Some("matrix"), &head, &rows))
            }
            p.note { "Drop of AP@0.5, and of the hit rate in small. The darker, the larger the drop of AP@0.5; bold: an effect is shown, and of the hit rate that it changes, on paired photos." }
        }
    }
}

fn transfer_cell(scores: &Scores, row: &TransferRow, cell: &TransferDrop) -> Markup {
    let d = &cell.drop;
    let compared = paired::compared(scores, &cell.detector, &row.variant);
    let is_shown = compared.is_some_and(paired::is_confidence_shown);
    let bold = |is_shown: bool, text: String| html! { @if is_shown { b { (text) } } @else { (text) } };
    html! {
        td style=(format!("background:{};color:{}", shade(d.ap50), ink(d.ap50))) {
            (bold(is_shown, number(d.ap50, 3))) br;
            small { (bold(compared.is_some_and(paired::is_hit_rate_shown), number(d.hit_rate, 2))) }
        }
    }
}
