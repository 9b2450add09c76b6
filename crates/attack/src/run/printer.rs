//! The colours that a printer makes of the cells, and their derivatives: the pattern is optimised for what comes out of the printer.

use serde::{Serialize, Serializer};

use super::cells::Rgb;
use scaleproof_surface::pattern::gamut::Gamut;

/// Step of the finite differences, half a step of 8 bits: the map is linear in CIELAB over far larger ones.
const STEP: f64 = 0.5 / 255.0;

/// A printer's measured map from requested to printed colours; `pattern check` predicts by the same.
#[derive(Debug, Clone, PartialEq)]
pub struct PrinterMap {
    gamut: Gamut,
    /// SHA-256 of the printer file.
    sha256: String,
}

impl PrinterMap {
    pub fn new(gamut: Gamut, sha256: String) -> Self {
        Self { gamut, sha256 }
    }

    /// Returns the printed colour of each requested cell; sRGB of 0 to 1, as the cells.
    pub fn printed(&self, cells: &[Rgb]) -> Vec<Rgb> {
        cells.iter().map(|cell| self.printed_cell(*cell)).collect()
    }

    /// Converts the gradient with respect to printed colours to that with respect to requested ones.
    pub fn vjp(&self, cells: &[Rgb], gradient: &[Rgb]) -> Vec<Rgb> {
        let of_cell = |(cell, gradient): (&Rgb, &Rgb)| {
            std::array::from_fn(|channel| {
                let at = |by: f64| {
                    let mut moved = *cell;
                    moved[channel] = (moved[channel] + by).clamp(0.0, 1.0);
                    (moved[channel], self.printed_cell(moved))
                };
                let ((low, below), (high, above)) = (at(-STEP), at(STEP));
                let along: f64 = (0..3).map(|c| gradient[c] * (above[c] - below[c])).sum();
                along / (high - low)
            })
        };
        cells.iter().zip(gradient).map(of_cell).collect()
    }

    fn printed_cell(&self, cell: Rgb) -> Rgb {
        self.gamut.printed_between(cell.map(|v| 255.0 * v)).srgb()
    }
}

/// In settings, a printer is the hash of its file.
impl Serialize for PrinterMap {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        self.sha256.serialize(to)
    }
}
