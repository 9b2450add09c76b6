//! A chart that a page shows inline, and that is also a file: by itself or beside others.

use maud::{Markup, html};

use super::{INK, NOTE, document};

const CAPTION: f64 = 20.0;
const LEGEND: f64 = 26.0;
const MARGIN: f64 = 8.0;
const NOTE_LINE: f64 = 15.0;
/// About what a letter of a note takes.
const NOTE_LETTER: f64 = 6.0;

/// Marks, and the part of their plane that is shown.
pub struct Drawing {
    pub area: [f64; 4],
    /// What it shows, in words.
    pub label: String,
    pub marks: Markup,
}

impl Drawing {
    /// For a page, which says by the class how large it is.
    pub fn inline(&self, class: Option<&str>) -> Markup {
        let [left, top, width, height] = self.area;
        html! {
            svg class=[class] viewBox=(format!("{left} {top} {width} {height}")) role="img" aria-label=(self.label) { (self.marks) }
        }
    }
}

/// What explains a figure: a legend of (colour, name) above it, and lines of text below it.
#[derive(Default)]
pub struct Explained {
    pub legend: Vec<(String, String)>,
    pub notes: Vec<String>,
}

/// One file of several drawings, each under its name, at most `across` a row, with what explains them.
pub fn figure(title: &str, explained: &Explained, across: usize, drawings: &[(&str, Drawing)]) -> String {
    let Explained { legend, notes } = explained;
    let largest = |side: usize| drawings.iter().map(|(_, d)| d.area[side]).fold(0.0, f64::max);
    let columns = across.clamp(1, drawings.len().max(1));
    let cell = (largest(2) + MARGIN, largest(3) + CAPTION + MARGIN);
    let top = if legend.is_empty() { MARGIN } else { LEGEND };
    let (legend, legend_width) = legend_marks(legend);
    let rows = drawings.len().div_ceil(columns);
    let noted = notes
        .iter()
        .map(|note| MARGIN + NOTE_LETTER * note.chars().count() as f64);
    let width = noted.fold((MARGIN + cell.0 * columns as f64).max(legend_width), f64::max);
    let bottom = top + cell.1 * rows as f64;
    let content = html! {
        (legend)
        @for (i, (name, drawing)) in drawings.iter().enumerate() {
            @let at = (MARGIN + cell.0 * (i % columns) as f64, top + cell.1 * (i / columns) as f64);
            text x=(at.0 + drawing.area[2] / 2.0) y=(at.1 + 13.0) font-size="12" font-weight="600" text-anchor="middle" fill=(INK) { (name) }
            g transform=(format!("translate({} {})", at.0 - drawing.area[0], at.1 + CAPTION - drawing.area[1])) { (drawing.marks) }
        }
        @for (i, note) in notes.iter().enumerate() {
            text x=(MARGIN) y=(bottom + NOTE_LINE * (i as f64 + 0.7)) font-size="10" fill=(NOTE) { (note) }
        }
    };
    document(width, bottom + NOTE_LINE * notes.len() as f64, title, &content)
}

/// A row of coloured squares with their names, and how wide it is.
fn legend_marks(entries: &[(String, String)]) -> (Markup, f64) {
    // About what letters of 11 px take.
    let width = |name: &str| 30.0 + 6.8 * name.chars().count() as f64;
    let starts = entries.iter().scan(MARGIN, |next, (_, name)| {
        let start = *next;
        *next += width(name);
        Some(start)
    });
    let marks = html! {
        @for ((colour, name), x) in entries.iter().zip(starts) {
            rect x=(x) y="6" width="10" height="10" fill=(colour) stroke=(INK) stroke-width="0.5" {}
            text x=(x + 15.0) y="15" font-size="11" fill=(INK) { (name) }
        }
    };
    (marks, MARGIN + entries.iter().map(|(_, name)| width(name)).sum::<f64>())
}
