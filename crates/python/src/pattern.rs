//! Patterns as arrays, and their files.

use std::path::PathBuf;

use image::RgbImage;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use scaleproof_core::files;
use scaleproof_surface::pattern::Pattern;
use scaleproof_surface::pattern::card::Card;

use crate::error::{Error, refused, unpanicked};

/// Columns, rows, colours (red, green, blue; row by row) and SHA-256 of a pattern's file.
#[pyfunction]
pub fn pattern_load(py: Python<'_>, path: PathBuf) -> PyResult<(u32, u32, Py<PyBytes>, String)> {
    let found = py.detach(|| unpanicked(|| Pattern::load(&path).map_err(refused))?)?;
    let colours = PyBytes::new(py, found.cells().as_raw()).unbind();
    Ok((found.columns(), found.rows(), colours, found.sha256().to_owned()))
}

/// Writes a pattern's PNG, and beside it a card where a repeat's width is known; `about` is a JSON object of what else the card says.
#[pyfunction]
#[pyo3(signature = (path, columns, rows, colours, tile_mm, about))]
pub fn pattern_save(
    py: Python<'_>,
    path: PathBuf,
    columns: u32,
    rows: u32,
    colours: Vec<u8>,
    tile_mm: Option<f64>,
    about: &str,
) -> PyResult<()> {
    py.detach(|| {
        unpanicked(|| {
            let cells = RgbImage::from_raw(columns, rows, colours);
            let cells = cells.ok_or_else(|| Error::new_err("the pattern has too few colours for its cells"))?;
            let pattern = Pattern::from_cells(cells).map_err(refused)?;
            let mut all = vec![(path.clone(), pattern.to_png().map_err(refused)?)];
            if let Some(tile_mm) = tile_mm {
                let card = Card {
                    pattern_sha256: pattern.sha256().to_owned(),
                    tile_mm,
                    sides: false,
                    about: serde_json::from_str(about).map_err(refused)?,
                };
                all.push(card.to_file(&path).map_err(refused)?);
            }
            files::write_beside(&[&path], &all).map_err(refused)
        })?
    })
}
