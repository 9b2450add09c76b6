//! Series of a chart: their names and colours, and the colours of all else.

use super::mark::Colour;

/// Colours of the series, in their order; an eleventh series starts over. The last two are Paul Tol's wine and grey.
#[rustfmt::skip]
const COLOURS: [u32; 10] = [
    0x0072b2, 0xd55e00, 0x009e73, 0xcc79a7, 0xe69f00, 0x56b4e9, 0x000000, 0x8c6d00, 0x882255, 0x9a9a9a,
];
pub const BLACK: Colour = Colour(0x000000);
pub const WHITE: Colour = Colour(0xffffff);
/// Colour of primary text.
pub const INK: Colour = Colour(0x1b1f24);
/// Colour of explanatory text.
pub const NOTE: Colour = Colour(0x5b6573);
/// Colour of grid lines.
pub const FAINT: Colour = Colour(0xd7dce2);

pub fn colour(series: usize) -> Colour {
    Colour(COLOURS[series % COLOURS.len()])
}

/// Returns each distinct name once, in the order of first occurrence.
pub fn distinct<T: PartialEq>(names: impl IntoIterator<Item = T>) -> Vec<T> {
    names.into_iter().fold(Vec::new(), |mut known, name| {
        if !known.contains(&name) {
            known.push(name);
        }
        known
    })
}
