//! Table of hits and misses.

use crate::figures::{Scores, Summary};
use crate::report::table::{Cell, Column, Table};
use crate::report::tables::by_detector::by_detector;

/// Returns hits, photos with another class alone, photos with nothing on the model, and hallucinations.
pub(crate) fn outcomes(scores: &Scores) -> Table {
    let mut table = Table::new(
        "Hits and misses",
        vec![
            Column::words("detector"),
            Column::words("texture"),
            Column::numbers("hits"),
            Column::numbers("misclassified"),
            Column::numbers("disappeared"),
            Column::numbers("hallucinations a photo").called("hallucinations_per_image"),
        ],
    );
    let cells = |s: &Summary| {
        let f = &s.overall;
        vec![
            Cell::share(f.hit_rate.count, f.photos),
            Cell::count(f.misclassification_rate.count),
            Cell::count(f.disappearance_rate.count),
            Cell::number(f.hallucinations_per_image, 2),
        ]
    };
    by_detector(scores, cells).for_each(|rows| table.add_block(rows));
    table
}
