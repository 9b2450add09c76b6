//! A table as HTML.

use maud::{Markup, html};

use crate::report::charts::shade::{ink, shade};
use crate::report::table::{Alignment, Cell, Table, Value};
use crate::report::words::number;

/// Number of letters above which a remark stands below its value.
const LONG: usize = 12;

impl Table {
    /// Renders the table, which scrolls sideways where it is wider than the page, and its notes.
    pub(crate) fn markup(&self) -> Markup {
        html! {
            div.scroll {
                table aria-label=(self.caption) {
                    thead { tr { @for column in &self.columns {
                        th class=[(column.alignment == Alignment::Left).then_some("text")] { (column.title) @if let Some(unit) = column.unit { br; small { (unit) } } }
                    } } }
                    tbody { @for block in &self.blocks { @for (i, row) in block.iter().enumerate() {
                        tr.first[i == 0] { @for (cell, column) in row.iter().zip(&self.columns) { (cell.markup(column.alignment)) } }
                    } } }
                }
            }
            @for note in &self.notes { p.note { (note) "." } }
        }
    }
}

impl Cell {
    fn markup(&self, alignment: Alignment) -> Markup {
        let style = self
            .shade
            .map(|share| format!("background:{};color:{}", shade(share), ink(share)));
        let words = html! { @if self.is_strong { b { (self.words(number)) } } @else { (self.words(number)) } };
        html! {
            td class=[(alignment == Alignment::Left).then_some("text")] style=[style] {
                @if !self.is_repeated && self.value != Value::Text(String::new()) {
                    (words)
                    @if let Some(interval) = self.interval_words(number) { " " small { (interval) } }
                    @if let Some(remark) = &self.remark {
                        @if remark.chars().count() > LONG { br; } @else { " " }
                        small.why { "(" (remark) ")" }
                    }
                }
            }
        }
    }
}
