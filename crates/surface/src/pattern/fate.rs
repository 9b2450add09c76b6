//! Colours of a pattern on a printer: those that come out, and the best input colours for the others.

use super::Pattern;
use super::colour::Lab;
use super::gamut::{Gamut, PRINTABLE_DELTA_E};
use super::printed::PrintedColours;

/// A colour of a pattern on a printer.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct ColourFate {
    /// A colour of the pattern, 8-bit sRGB like the others here.
    pub wanted_rgb: [u8; 3],
    /// Number of cells that have it.
    pub cells: usize,
    /// Colour that comes out when it is printed as it is; in `printed_delta_e`, its ΔE2000 from the wanted one.
    pub printed_rgb: [u8; 3],
    pub printed_delta_e: f64,
    /// Best input colour; in `best_rgb` the colour that then comes out, and in `best_delta_e` its ΔE2000 from the wanted one.
    pub best_ask_rgb: [u8; 3],
    pub best_rgb: [u8; 3],
    pub best_delta_e: f64,
    /// True if `best_delta_e` is at most 2.
    pub is_printable: bool,
}

/// A pattern on a printer.
#[derive(Debug, Clone, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct PatternFate {
    /// Non-printability score: mean over cells of the distance to the nearest measured colour, Euclidean in sRGB with channels
    /// from 0 to 1; 0 is printable, √3 the most there could be. The minimum-distance form in use since; Sharif et al. 2016,
    /// eq. 5, has the product over the palette.
    pub nps: f64,
    /// Share of cells for whose colour no printable one is within ΔE2000 2.
    pub out_of_gamut_share: f64,
    /// Mean over cells of the ΔE2000 when the pattern is printed as it is, and with the best input colours.
    pub printed_delta_e_mean: f64,
    pub best_delta_e_mean: f64,
    /// Every colour of the pattern once, the worst printable first.
    pub colours: Vec<ColourFate>,
}

pub fn fate(pattern: &Pattern, printer: &PrintedColours) -> PatternFate {
    let gamut = printer.gamut();
    let counts = pattern.colour_counts().into_iter();
    let mut colours: Vec<_> = counts.map(|(rgb, cells)| colour_fate(rgb, cells, &gamut)).collect();
    // Stable: of equals, the colours stay in their order.
    colours.sort_by(|a, b| b.best_delta_e.total_cmp(&a.best_delta_e));
    let all = colours.iter().map(|c| c.cells).sum::<usize>() as f64;
    let mean = |of: &dyn Fn(&ColourFate) -> f64| colours.iter().map(|c| of(c) * c.cells as f64).sum::<f64>() / all;
    PatternFate {
        nps: mean(&|c| nearest(c.wanted_rgb, printer)),
        out_of_gamut_share: mean(&|c| if c.is_printable { 0.0 } else { 1.0 }),
        printed_delta_e_mean: mean(&|c| c.printed_delta_e),
        best_delta_e_mean: mean(&|c| c.best_delta_e),
        colours,
    }
}

fn colour_fate(wanted_rgb: [u8; 3], cells: usize, gamut: &Gamut) -> ColourFate {
    let wanted = Lab::from_rgb(wanted_rgb);
    let (printed, best) = (gamut.printed(wanted_rgb), gamut.best(wanted));
    ColourFate {
        wanted_rgb,
        cells,
        printed_rgb: printed.rgb(),
        printed_delta_e: printed.delta_e(wanted),
        best_ask_rgb: best.ask_rgb,
        best_rgb: best.lab.rgb(),
        best_delta_e: best.delta_e,
        is_printable: best.delta_e <= PRINTABLE_DELTA_E,
    }
}

/// Returns the distance in sRGB, channels from 0 to 1, to the nearest measured colour.
fn nearest(rgb: [u8; 3], printer: &PrintedColours) -> f64 {
    let distance = |other: [u8; 3]| {
        let squares = (0..3).map(|c| (f64::from(rgb[c]) - f64::from(other[c])).powi(2));
        squares.sum::<f64>().sqrt() / 255.0
    };
    let distances = printer.patches.iter().map(|p| distance(p.measured_rgb));
    distances.fold(f64::INFINITY, f64::min)
}
