//! The cells as a printer makes them, and the derivative of that: the pattern is then moved for what comes out of the printer, not for what is
//! asked of it.

use serde::{Serialize, Serializer};

use super::Rgb;
use scaleproof_surface::pattern::gamut::Gamut;

/// Half a step of 8 bits: the map is linear in CIELAB over far larger ones.
const STEP: f64 = 0.5 / 255.0;

/// A printer's measured map from requested to printed colours; `pattern check` predicts by the same.
#[derive(Debug, Clone, PartialEq)]
pub struct PrinterMap {
    gamut: Gamut,
    /// Of the printer file.
    sha256: String,
}

impl PrinterMap {
    pub fn new(gamut: Gamut, sha256: String) -> Self {
        Self { gamut, sha256 }
    }

    /// What comes out for each requested cell; sRGB of 0 to 1, as the cells.
    pub fn printed(&self, cells: &[Rgb]) -> Vec<Rgb> {
        cells.iter().map(|cell| self.of(*cell)).collect()
    }

    /// From the derivative with respect to what comes out to that with respect to what is requested.
    pub fn vjp(&self, cells: &[Rgb], gradient: &[Rgb]) -> Vec<Rgb> {
        let of_cell = |(cell, gradient): (&Rgb, &Rgb)| {
            std::array::from_fn(|channel| {
                let at = |by: f64| {
                    let mut moved = *cell;
                    moved[channel] = (moved[channel] + by).clamp(0.0, 1.0);
                    (moved[channel], self.of(moved))
                };
                let ((low, below), (high, above)) = (at(-STEP), at(STEP));
                let along: f64 = (0..3).map(|c| gradient[c] * (above[c] - below[c])).sum();
                along / (high - low)
            })
        };
        cells.iter().zip(gradient).map(of_cell).collect()
    }

    fn of(&self, cell: Rgb) -> Rgb {
        self.gamut.printed_between(cell.map(|v| 255.0 * v)).srgb()
    }
}

/// In settings, a printer is the hash of its file.
impl Serialize for PrinterMap {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        self.sha256.serialize(to)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scaleproof_surface::pattern::colour::Lab;

    /// A printer that mixes the channels and darkens, measured at six levels.
    fn printer() -> PrinterMap {
        let levels = [0, 51, 102, 153, 204, 255];
        let comes_out = |rgb: [u8; 3]| {
            let [r, g, b] = rgb.map(|v| f64::from(v) / 255.0);
            Lab::from_linear([
                0.05 + 0.6 * r * r + 0.1 * g,
                0.04 + 0.5 * g,
                0.06 + 0.4 * b + 0.1 * r * g,
            ])
        };
        PrinterMap::new(Gamut::new(&levels, comes_out), String::new())
    }

    #[test]
    fn the_derivative_is_that_of_the_map() {
        let printer = printer();
        let cells = vec![[0.31, 0.52, 0.77], [0.93, 0.12, 0.48], [0.0, 1.0, 0.5]];
        let gradient = vec![[1.0, -2.0, 0.5], [0.3, 0.7, -1.0], [1.0, 1.0, 1.0]];
        let found = printer.vjp(&cells, &gradient);
        let value = |cells: &[Rgb]| -> f64 {
            let printed = printer.printed(cells);
            printed
                .iter()
                .flatten()
                .zip(gradient.iter().flatten())
                .map(|(p, g)| p * g)
                .sum()
        };
        for cell in 0..3 {
            for channel in 0..3 {
                // Inwards at the ends of the range.
                let by = if cells[cell][channel] == 1.0 { -1e-4 } else { 1e-4 };
                let mut moved = cells.clone();
                moved[cell][channel] += by;
                let difference = (value(&moved) - value(&cells)) / by;
                let derivative = found[cell][channel];
                assert!(
                    (difference - derivative).abs() < 0.02 * (1.0 + derivative.abs()),
                    "{difference} {derivative}"
                );
            }
        }
    }

    #[test]
    fn cells_of_eight_bits_come_out_as_pattern_check_says() {
        let printer = printer();
        for cell in [[0, 51, 102], [12, 200, 255], [255, 255, 255]] {
            let [printed] = printer.printed(&[cell.map(|v| f64::from(v) / 255.0)])[..] else {
                unreachable!()
            };
            let expected = printer.gamut.printed(cell).rgb();
            assert_eq!(printed.map(|v| (255.0 * v).round() as u8), expected);
        }
    }
}
