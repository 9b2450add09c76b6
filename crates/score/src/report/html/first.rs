//! First screen of a page: the verdict, photos side by side, each drop with its interval, the table of effects, and the cautions.

use maud::{Markup, html};

use crate::figures::{Compared, Scores};
use crate::report::html::{contact, intervals, strip};
use crate::report::tables;
use crate::report::words::{paired, verdict};

/// Renders the first screen of a report or comparison; a table of figures where nothing is compared.
pub(crate) fn screen(scores: &Scores, results: &[Compared], base: &str) -> Markup {
    html! {
        @for sentence in verdict::sentences(scores, results, base) { p.verdict { (sentence) "." } }
        @if results.is_empty() {
            (tables::figures_of_screen(scores).markup())
        } @else {
            (strip::rows(scores, results, base))
            (intervals::figure(scores, results, base))
            (tables::effects(scores, results, base).markup())
            p.note { (basis(results)) }
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
pub(crate) fn library(
    scores: &Scores,
    results: &[Compared],
    base: &str,
    others: Vec<&crate::figures::photo::ScoredPhoto>,
) -> Markup {
    let mut photos = others;
    for photo in strip::photos(scores, results, base) {
        if photos.iter().all(|known| known.id != photo.id) {
            photos.push(photo);
        }
    }
    contact::photo_library(&photos)
}
