//! The repeated pattern: a small grid of coloured cells, stored as a PNG with one pixel per cell.

pub mod area;
pub mod card;
pub mod colour;
pub mod contrast;
pub mod enlarged;
pub mod fate;
pub mod gamut;
pub mod import;
pub mod light;
pub(crate) mod numpy;
pub mod palette;
pub mod picture;
pub mod printed;
pub mod world_aligned;

use std::collections::BTreeMap;
use std::io::Cursor;
use std::path::{Path, PathBuf};

use image::{DynamicImage, ImageDecoder, ImageFormat, RgbImage};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg32;

use scaleproof_core::files::{self, FileError};
use scaleproof_photo::{Budget, open_png};

/// Largest number of cells of a pattern along one side. Above this an image is almost surely meant, not a grid of cells.
pub const MAX_CELLS: u32 = 512;

/// Reason why there is no pattern. Each variant says what to change.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PatternError {
    #[error("{0}; a pattern is a PNG file with one pixel per cell")]
    Unreadable(#[from] FileError),
    #[error("{path} is not a PNG file; save the pattern as PNG with one pixel per cell", path = path.display())]
    NotPng { path: PathBuf },
    #[error("{path} is a damaged PNG file ({reason}); export it again", path = path.display())]
    Damaged { path: PathBuf, reason: String },
    #[error("{path} is see-through at column {column}, row {row}; flatten it onto an opaque colour, paper has none", path = path.display())]
    Transparent { path: PathBuf, column: u32, row: u32 },
    #[error("{path} has {columns}×{rows} pixels; scale it down to one pixel per cell, at most {MAX_CELLS}×{MAX_CELLS}", path = path.display())]
    TooManyCells { path: PathBuf, columns: u32, rows: u32 },
    #[error("a pattern of {cells}×{cells} cells cannot be made; ask for 1 to {MAX_CELLS} cells a side")]
    BadCellCount { cells: u32 },
    #[error("the pattern could not be written as PNG: {reason}")]
    Encode { reason: String },
}

/// A grid of opaque RGB cells that is repeated over a surface. Row 0 is the top row.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pattern {
    cells: RgbImage,
    sha256: String,
}

impl Pattern {
    /// Reads a PNG with one pixel per cell.
    ///
    /// # Errors
    /// An unreadable file, anything but a PNG, a see-through pixel, more than `MAX_CELLS` cells along a side.
    pub fn load(path: &Path) -> Result<Self, PatternError> {
        let bytes = files::read(path)?;
        if image::guess_format(&bytes).ok() != Some(ImageFormat::Png) {
            return Err(PatternError::NotPng { path: path.to_owned() });
        }
        let image = decode(path, &bytes)?;
        // 16 bits, so that an alpha of 65534 is not rounded to opaque.
        let deep = image.to_rgba16();
        let mut pixels = deep.enumerate_pixels();
        if let Some((column, row, _)) = pixels.find(|(_, _, pixel)| pixel.0[3] != u16::MAX) {
            let path = path.to_owned();
            return Err(PatternError::Transparent { path, column, row });
        }
        Ok(Self {
            cells: image.to_rgb8(),
            sha256: files::sha256_hex(&bytes),
        })
    }

    /// Makes a square pattern whose cells are uniform in RGB. The same `cells` and `seed` give the same pattern on every machine
    /// and in every version: the bytes of PCG-XSH-RR 64/32 (O'Neill 2014) are the colours, row by row.
    ///
    /// # Errors
    /// No cells, or more than `MAX_CELLS` along a side.
    pub fn random(cells: u32, seed: u64) -> Result<Self, PatternError> {
        Self::random_grid([cells, cells], seed)
    }

    /// Makes a random pattern of so many columns and rows: the first rows of the square one that [`Pattern::random`] makes of as many columns.
    ///
    /// # Errors
    /// Those of [`Pattern::random`].
    pub fn random_grid([columns, rows]: [u32; 2], seed: u64) -> Result<Self, PatternError> {
        if let Some(cells) = [columns, rows].into_iter().find(|n| !(1..=MAX_CELLS).contains(n)) {
            return Err(PatternError::BadCellCount { cells });
        }
        let mut grid = RgbImage::new(columns, rows);
        Pcg32::seed_from_u64(seed).fill_bytes(&mut grid);
        Self::from_cells(grid)
    }

    /// Makes a pattern of an image with one pixel per cell.
    ///
    /// # Errors
    /// Only if the encoder fails.
    pub fn from_cells(cells: RgbImage) -> Result<Self, PatternError> {
        let sha256 = files::sha256_hex(&png_of(&cells)?);
        Ok(Self { cells, sha256 })
    }

    /// Returns the cells; pixel (0, 0) is the top-left cell.
    pub fn cells(&self) -> &RgbImage {
        &self.cells
    }

    /// Returns the number of cells across.
    pub fn columns(&self) -> u32 {
        self.cells.width()
    }

    /// Returns the number of cells down.
    pub fn rows(&self) -> u32 {
        self.cells.height()
    }

    /// Returns every colour with the number of its cells.
    pub fn colour_counts(&self) -> BTreeMap<[u8; 3], usize> {
        let mut counts = BTreeMap::new();
        for cell in self.cells.pixels() {
            *counts.entry(cell.0).or_default() += 1;
        }
        counts
    }

    /// Returns the pattern with each cell's colour replaced by `colour` of it.
    ///
    /// # Errors
    /// Only if the encoder fails.
    pub fn recoloured(&self, colour: impl Fn([u8; 3]) -> [u8; 3]) -> Result<Self, PatternError> {
        let mut cells = self.cells.clone();
        cells.pixels_mut().for_each(|cell| cell.0 = colour(cell.0));
        Self::from_cells(cells)
    }

    /// Returns `count` of its rows, from `first` on.
    ///
    /// # Errors
    /// Only if the encoder fails.
    pub fn rows_from(&self, first: u32, count: u32) -> Result<Self, PatternError> {
        Self::from_cells(image::imageops::crop_imm(&self.cells, 0, first, self.columns(), count).to_image())
    }

    /// Returns the picture in more cells, each divided evenly; `None` where they are not as many or the same whole multiple across and down.
    pub fn divided(&self, [columns, rows]: [u32; 2]) -> Option<RgbImage> {
        let fits = columns.is_multiple_of(self.columns()) && rows.is_multiple_of(self.rows());
        let (across, down) = (columns / self.columns(), rows / self.rows());
        (fits && across == down)
            .then(|| RgbImage::from_fn(columns, rows, |x, y| *self.cells.get_pixel(x / across, y / down)))
    }

    /// Returns the pattern as a PNG file with one pixel per cell.
    ///
    /// # Errors
    /// Only if the encoder fails.
    pub fn to_png(&self) -> Result<Vec<u8>, PatternError> {
        png_of(&self.cells)
    }

    /// Returns the SHA-256, in lower-case hex, of the file this pattern was loaded from, or of its PNG if it was made here.
    pub fn sha256(&self) -> &str {
        &self.sha256
    }
}

fn decode(path: &Path, bytes: &[u8]) -> Result<DynamicImage, PatternError> {
    let damaged = |reason: String| PatternError::Damaged {
        path: path.to_owned(),
        reason,
    };
    let decoder = open_png(bytes, &Budget::FILE).map_err(|e| damaged(e.to_string()))?;
    // The size stands in the header: a huge image is refused before its pixels take memory.
    let (columns, rows) = decoder.dimensions();
    if columns > MAX_CELLS || rows > MAX_CELLS {
        return Err(PatternError::TooManyCells {
            path: path.to_owned(),
            columns,
            rows,
        });
    }
    DynamicImage::from_decoder(decoder).map_err(|e| damaged(e.to_string()))
}

fn png_of(cells: &RgbImage) -> Result<Vec<u8>, PatternError> {
    let mut file = Cursor::new(Vec::new());
    cells
        .write_to(&mut file, ImageFormat::Png)
        .map_err(|e| PatternError::Encode { reason: e.to_string() })?;
    Ok(file.into_inner())
}
