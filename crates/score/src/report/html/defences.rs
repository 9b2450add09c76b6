//! Drops of AP under each defence, and what each defence changes, as two tables.

use maud::{Markup, html};

use super::table;
use crate::report::defences::tables;
use crate::score::Scores;

/// `None` where it was not asked for.
pub(super) fn section(scores: &Scores) -> Option<Markup> {
    let defences = scores.defences.as_ref()?;
    let matrix = |rows: &[Vec<String>]| {
        let head = html! { @for head in &rows[0] { th { (head) } } };
        let lines = html! { @for row in &rows[1..] { tr { @for cell in row { td { (cell) } } } } };
        table(Some("matrix"), &head, &lines)
    };
    let [(drops, drop_rows), (changes, change_rows)] = tables(defences);
    Some(html! {
        (matrix(&drop_rows))
        p.note { (drops) "." }
        h3 { "What each defence changes" }
        (matrix(&change_rows))
        p.note { (changes) "." }
        p.note { "Photos are reduced to 640 px along the longer side, then defended. What is random follows from a photo's content." }
        dl { @for defence in &defences.defences { dt { (defence.name) } dd { (defence.does) " (" (defence.source) ")" } } }
        @for caution in &defences.cautions { p.note { (caution) } }
    })
}
