//! Drops of AP under each defence, and what each defence changes, as two tables.

use maud::{Markup, html};

use crate::figures::Scores;
use crate::report::tables;

/// Renders the section; `None` for a run without defences.
pub(crate) fn section(scores: &Scores) -> Option<Markup> {
    let defences = scores.defences.as_ref()?;
    Some(html! {
        @for table in tables::defended(defences) { p.note { (table.caption) "." } (table.markup()) }
        p.note { "Photos are reduced to 640 px along the longer side, then defended. What is random follows from a photo's content." }
        dl { @for defence in &defences.defences { dt { (defence.name) } dd { (defence.does) " (" (defence.source) ")" } } }
        @for caution in &defences.cautions { p.note { (caution) } }
    })
}
