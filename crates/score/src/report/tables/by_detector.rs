//! Rows of a table, grouped by detector.

use crate::figures::{Scores, Summary};
use crate::report::table::Cell;

/// Returns a block of rows for each detector, a row for each of its variants, with these cells behind the two names.
pub(crate) fn by_detector<'a>(
    scores: &'a Scores,
    cells: impl Fn(&'a Summary) -> Vec<Cell> + 'a,
) -> impl Iterator<Item = Vec<Vec<Cell>>> + 'a {
    let detectors = scores.summaries.chunk_by(|a, b| a.detector == b.detector);
    detectors.map(move |own| {
        let names = |s: &Summary| vec![Cell::text(scores.title(&s.detector)), Cell::text(&s.variant)];
        own.iter().map(|s| [names(s), cells(s)].concat()).collect()
    })
}
