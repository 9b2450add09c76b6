//! What became of the model where it was not found, and how far a pattern's effect carries over to other detectors.

use maud::{Markup, html};

use super::shade::{ink, shade};
use super::{ACROSS, heads, number, rows_by_detector, table, title_of};
use crate::report::paired;
use crate::score::{Compared, Difference, Figures, Scores, Summary, TransferDrop, TransferRow, transfer};

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
            p.note { "Drop of AP@0.5, and of the hit rate in small. The darker, the larger the drop of AP@0.5; bold: shown after correction, on paired photos." }
        }
    }
}

fn transfer_cell(scores: &Scores, row: &TransferRow, cell: &TransferDrop) -> Markup {
    let d = &cell.drop;
    let compared = paired::compared(scores, &cell.detector, &row.variant);
    let is_shown = |of: fn(&Compared) -> &Difference| compared.is_some_and(|r| paired::is_shown(of(r)));
    let bold = |is_shown: bool, text: String| html! { @if is_shown { b { (text) } } @else { (text) } };
    html! {
        td style=(format!("background:{};color:{}", shade(d.ap50), ink(d.ap50))) {
            (bold(is_shown(|r| &r.ap50), number(d.ap50, 3))) br;
            small { (bold(is_shown(|r| &r.hit_rate.rate), number(d.hit_rate, 2))) }
        }
    }
}
