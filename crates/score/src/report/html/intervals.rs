//! Chart of the drops of the mean confidence, with its legend.

use maud::{Markup, html};

use crate::report::Findings;
use crate::report::charts::intervals::{MARKS, chart, colour_of, textures};

/// Renders the chart with its legend.
pub(crate) fn figure(findings: Findings) -> Markup {
    let scores = findings.scores;
    let textures = textures(findings.results);
    html! {
        ul.legend {
            @for texture in &textures { li { i style=(format!("background:{}", colour_of(scores, texture))) {} (texture) } }
            li.note { (MARKS) "." }
        }
        div.scroll { (chart(findings).inline(Some("intervals"))) }
    }
}
