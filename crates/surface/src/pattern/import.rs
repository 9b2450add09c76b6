//! A pattern from any image: the mean colour of each of its cells.

use super::area::averaged;
use super::picture::Picture;
use super::{MAX_CELLS, Pattern, PatternError, enlarged};

/// Reason why an image became no pattern.
#[derive(Debug, thiserror::Error)]
pub enum PatternImportError {
    #[error(
        "{columns}×{rows} cells cannot be made of {width}×{height} pixels; ask for 1 to {MAX_CELLS} cells a side, and no more than it has pixels"
    )]
    Cells {
        columns: u32,
        rows: u32,
        width: u32,
        height: u32,
    },
    #[error(transparent)]
    Pattern(#[from] PatternError),
}

/// Returns the image in cells, each the mean of its area in linear light.
pub fn in_cells(picture: &Picture, [columns, rows]: [u32; 2]) -> Result<Pattern, PatternImportError> {
    let (width, height) = picture.pixels.dimensions();
    let fits = |cells: u32, pixels: u32| (1..=MAX_CELLS.min(pixels)).contains(&cells);
    if !(fits(columns, width) && fits(rows, height)) {
        return Err(PatternImportError::Cells {
            columns,
            rows,
            width,
            height,
        });
    }
    Ok(Pattern::from_cells(averaged(&picture.pixels, [columns, rows], 1.0))?)
}

/// Returns the pattern that the image is an enlarged grid of, if it is one.
///
/// # Errors
/// Only if the encoder fails.
pub fn enlarged_pattern(picture: &Picture) -> Result<Option<Pattern>, PatternError> {
    let grid = enlarged::grid_of(&picture.pixels);
    grid.map(|grid| Pattern::from_cells(enlarged::cells_of(&picture.pixels, grid)))
        .transpose()
}

/// Returns the number of rows that makes cells of an image about square.
pub fn rows_for(picture: &Picture, columns: u32) -> u32 {
    let rows = picture.height_for(f64::from(columns)).round();
    rows.clamp(1.0, f64::from(u32::MAX)) as u32
}
