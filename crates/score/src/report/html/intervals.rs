//! Chart of the drops of the mean confidence, with its legend.

use maud::{Markup, html};

use crate::figures::{Compared, Scores};
use crate::report::charts::intervals::{MARKS, chart, colour_of, textures};

/// Renders the chart with its legend.
pub(crate) fn figure(scores: &Scores, results: &[Compared], base: &str) -> Markup {
    let textures = textures(results);
    html! {
        ul.legend {
            @for texture in &textures { li { i style=(format!("background:{}", colour_of(scores, texture))) {} (texture) } }
            li.note { (MARKS) "." }
        }
        div.scroll { (chart(scores, results, base).inline(Some("intervals"))) }
    }
}
