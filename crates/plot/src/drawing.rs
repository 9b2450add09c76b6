//! Chart that a page shows inline, and that is also a file, SVG or PDF: by itself or beside others.

use super::mark::Anchor::{Middle, Start};
use super::mark::{Colour, Mark};
use super::series::{INK, NOTE};

const CAPTION: f64 = 20.0;
const LEGEND: f64 = 26.0;
const MARGIN: f64 = 8.0;
const NOTE_LINE: f64 = 15.0;
/// Approximate width of a letter of a note.
const NOTE_LETTER: f64 = 6.0;

/// Marks, and the visible part of their plane: left, top, width, height.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawing {
    pub area: [f64; 4],
    /// Description of its content, in words.
    pub label: String,
    pub marks: Vec<Mark>,
}

/// Explanation of a figure: a legend of (colour, name) above it, and lines of text below it.
#[derive(Default)]
pub struct Explained {
    pub legend: Vec<(Colour, String)>,
    pub notes: Vec<String>,
}

/// Combines several drawings, each under its name, at most `across` per row, with their explanation.
pub fn figure(title: &str, explained: &Explained, across: usize, drawings: Vec<(&str, Drawing)>) -> Drawing {
    let Explained { legend, notes } = explained;
    let largest = |side: usize| drawings.iter().map(|(_, d)| d.area[side]).fold(0.0, f64::max);
    let columns = across.clamp(1, drawings.len().max(1));
    let cell = (largest(2) + MARGIN, largest(3) + CAPTION + MARGIN);
    let top = if legend.is_empty() { MARGIN } else { LEGEND };
    let rows = drawings.len().div_ceil(columns);
    let noted = notes
        .iter()
        .map(|note| MARGIN + NOTE_LETTER * note.chars().count() as f64);
    let (mut marks, legend_width) = legend_marks(legend);
    let width = noted.fold((MARGIN + cell.0 * columns as f64).max(legend_width), f64::max);
    let bottom = top + cell.1 * rows as f64;
    for (i, (name, drawing)) in drawings.into_iter().enumerate() {
        let [own_left, own_top, own_width, _] = drawing.area;
        let (x, y) = (
            MARGIN + cell.0 * (i % columns) as f64,
            top + cell.1 * (i / columns) as f64,
        );
        marks.push(Mark::text([x + own_width / 2.0, y + 13.0], 12.0, Middle, INK, name).bold());
        marks.push(Mark::group([x - own_left, y + CAPTION - own_top], drawing.marks));
    }
    for (i, note) in notes.iter().enumerate() {
        let baseline = bottom + NOTE_LINE * (i as f64 + 0.7);
        marks.push(Mark::text([MARGIN, baseline], 10.0, Start, NOTE, note));
    }
    Drawing {
        area: [0.0, 0.0, width, bottom + NOTE_LINE * notes.len() as f64],
        label: title.to_owned(),
        marks,
    }
}

/// Draws a row of coloured squares with their names; returns the marks and the row's width.
fn legend_marks(entries: &[(Colour, String)]) -> (Vec<Mark>, f64) {
    let (mut marks, mut x) = (Vec::new(), MARGIN);
    for (colour, name) in entries {
        marks.push(Mark::rect([x, 6.0], [10.0, 10.0]).filled(*colour).outlined(INK, 0.5));
        marks.push(Mark::text([x + 15.0, 15.0], 11.0, Start, INK, name));
        // Approximate width of letters of 11 px.
        x += 30.0 + 6.8 * name.chars().count() as f64;
    }
    (marks, x)
}
