//! A note where a pattern's pixels are not its cells.

use std::path::Path;

use crate::pattern::Pattern;
use crate::pattern::enlarged::grid_of;

/// From here on a pattern is looked at: smaller ones have cells of several pixels by chance or by design.
const LARGE: u32 = 64;

/// Says so where a pattern is another one, enlarged.
pub(crate) fn note_enlarged(path: &Path, pattern: &Pattern) {
    let [columns, rows] = [pattern.columns(), pattern.rows()];
    if columns.max(rows) < LARGE {
        return;
    }
    if let Some([across, down]) = grid_of(pattern.cells()) {
        let path = path.display();
        say!(
            "note: {path} is an enlarged grid of {across}×{down} cells, and its {columns}×{rows} pixels were taken as cells; make it a pattern by \
             scaleproof pattern import {path} -o pattern.png"
        );
    }
}
