//! Drops of AP under each defence, and what each defence changes, as two tables.

use maud::{Markup, html};

use crate::figures::Scores;
use crate::report::table::Table;

/// Renders the section; `None` for a run without defences.
pub(crate) fn section(scores: &Scores, tables: Option<&[Table; 2]>) -> Option<Markup> {
    let (defences, tables) = scores.defences.as_ref().zip(tables)?;
    Some(html! {
        @for table in tables { p.note { (table.caption) "." } (table.markup()) }
        p.note { "Photos are reduced to 640 px along the longer side, then defended. What is random follows from a photo's content." }
        dl { @for defence in &defences.defences { dt { (defence.name) } dd { (defence.does) " (" (defence.source) ")" } } }
        @for caution in &defences.cautions { p.note { (caution) } }
    })
}
