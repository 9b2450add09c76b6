//! Notes about images that are not what they look like: enlarged patterns, see-through pixels.

use std::path::Path;

use scaleproof_surface::pattern::Pattern;
use scaleproof_surface::pattern::enlarged::grid_of;
use scaleproof_surface::pattern::picture::{Picture, PictureError};

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

/// Any image; says what was done to it.
pub(crate) fn picture(path: &Path) -> Result<Picture, PictureError> {
    let picture = Picture::load(path)?;
    if let Some(clause) = &picture.note {
        say!("note: {} {clause}", path.display());
    }
    Ok(picture)
}
