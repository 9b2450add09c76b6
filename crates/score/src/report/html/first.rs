//! First screen of a page: the verdict, photos side by side, each drop with its interval, the table of effects, and the cautions.

use maud::{Markup, html};

use crate::figures::{Compared, ScoredPhoto};
use crate::report::Findings;
use crate::report::html::{charts, contact, strip};
use crate::report::table::Table;
use crate::report::words::{paired, verdict};

/// Renders the first screen of a page: with its `main` table, the effects, or figures where nothing is compared.
pub(crate) fn screen(findings: Findings, main: &Table) -> Markup {
    let scores = findings.scores;
    html! {
        @for sentence in verdict::sentences(findings) { p.verdict { (sentence) "." } }
        @if findings.results.is_empty() {
            (main.markup())
        } @else {
            (strip::rows(findings))
            (charts::intervals(findings))
            (main.markup())
            p.note { (basis(findings.results)) }
        }
        @if !scores.cautions.is_empty() {
            h3 { "To know before believing it" }
            ul.cautions { @for caution in &scores.cautions { li { (verdict::capitalised(caution)) "." } } }
        }
    }
}

/// Returns the numbers of pairs, places and bins that each texture's rows rest on.
fn basis(results: &[Compared]) -> String {
    let textures = results.chunk_by(|a, b| a.variant == b.variant);
    let each = textures.map(|own| format!("{}: {}", own[0].variant, paired::basis(&own[0])));
    each.collect::<Vec<_>>().join("; ") + "."
}

/// Renders the photos that a page shows, each once: those of the strip and `others`.
pub(crate) fn library(findings: Findings, others: Vec<&ScoredPhoto>) -> Markup {
    let mut photos = others;
    for photo in strip::photos(findings) {
        if photos.iter().all(|known| known.id != photo.id) {
            photos.push(photo);
        }
    }
    contact::photo_library(&photos)
}
