//! Bounds of the lengths that users give. Each length passes here before anything is computed with it, so that nothing behind
//! meets NaN or infinity, leaves the range of its integers, or divides by almost nothing.

use std::num::ParseFloatError;
use std::ops::RangeInclusive;

use crate::message::{Message, message};

/// The longest length, and the farthest place: a hall. A full-size lorry takes a fifth of it.
pub const LONGEST_MM: f64 = 100_000.0;
/// The smallest size of anything that is there: a micrometre.
pub const SHORTEST_MM: f64 = 0.001;
/// The farthest a camera stands: a kilometre.
pub const FARTHEST_MM: f64 = 1_000_000.0;
/// A model is 1:scale: from a fly at a hundred times its size to a city.
pub const SCALES: RangeInclusive<f64> = 0.01..=10_000.0;

/// A length that is refused, as a sentence.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{what} cannot be {value} mm; give {least} to {most} mm")]
pub struct BadLength {
    what: String,
    /// Value in words, as by [`shown`].
    value: String,
    least: f64,
    most: f64,
}

impl From<BadLength> for Message {
    fn from(error: BadLength) -> Message {
        message!("{error}")
    }
}

/// Checks the size of a thing. `what` begins the sentence of a refusal.
pub fn size_mm(what: &str, value: f64) -> Result<f64, BadLength> {
    within(what, value, SHORTEST_MM..=LONGEST_MM)
}

/// Checks a strip or a distance that may be 0.
pub fn strip_mm(what: &str, value: f64) -> Result<f64, BadLength> {
    within(what, value, 0.0..=LONGEST_MM)
}

/// Checks a glue tab: wide enough to hold, narrow enough to fold.
pub fn tab_mm(value: f64) -> Result<f64, BadLength> {
    within("a glue tab", value, 4.0..=15.0)
}

/// Checks a coordinate, which may be negative.
pub fn place_mm(what: &str, value: f64) -> Result<f64, BadLength> {
    within(what, value, -LONGEST_MM..=LONGEST_MM)
}

/// Units that a length may be followed by, and each in mm. An inch is 25.4 mm exactly.
const UNITS: [(&str, f64); 8] = [
    ("mm", 1.0),
    ("cm", 10.0),
    ("inches", 25.4),
    ("inch", 25.4),
    ("in", 25.4),
    ("\"", 25.4),
    ("ft", 304.8),
    ("m", 1000.0),
];

/// Reads a length in mm: a number of mm, or of the unit behind it, as in `17.9in`.
pub fn parse_mm(text: &str) -> Result<f64, ParseFloatError> {
    let (number, mm) = in_unit(text).unwrap_or((text, 1.0));
    Ok(mm * number.trim().parse::<f64>()?)
}

/// A text before its unit, and the unit in mm.
fn in_unit(text: &str) -> Option<(&str, f64)> {
    let text = text.trim_end();
    UNITS
        .iter()
        .find_map(|(unit, mm)| Some((text.strip_suffix(unit)?, *mm)))
}

/// Lengths in mm with an `x` between them, as in `210x297` or `8.5x14in`: a unit behind the last is that of the others, too.
pub fn parse_sides_mm<const N: usize>(text: &str) -> Option<[f64; N]> {
    let parts: Vec<&str> = text.split(['x', 'X', '×']).collect();
    let of_last = in_unit(parts.last()?).map_or(1.0, |(_, mm)| mm);
    let side = |part: &&str| match in_unit(part) {
        None => Some(of_last * part.trim().parse::<f64>().ok()?),
        Some(_) => parse_mm(part).ok(),
    };
    let sides: Option<Vec<f64>> = parts.iter().map(side).collect();
    sides?.try_into().ok()
}

/// Returns true if [`size_mm`] accepts it, for callers with an error of their own.
pub fn is_size(mm: f64) -> bool {
    (SHORTEST_MM..=LONGEST_MM).contains(&mm)
}

/// Formats a number for a sentence: plain, or with an exponent where it would fill a line.
pub fn shown(value: f64) -> String {
    let is_plain = value == 0.0 || !value.is_finite() || (1e-6..1e9).contains(&value.abs());
    if is_plain {
        value.to_string()
    } else {
        format!("{value:e}")
    }
}

/// Formats a number with up to three decimals and no trailing zeros.
pub fn number(value: f64) -> String {
    let text = format!("{value:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

fn within(what: &str, value: f64, range: RangeInclusive<f64>) -> Result<f64, BadLength> {
    // False for NaN.
    if range.contains(&value) {
        // Adding zero makes one zero of -0 and 0.
        return Ok(value + 0.0);
    }
    Err(BadLength {
        what: what.to_owned(),
        value: shown(value),
        least: *range.start(),
        most: *range.end(),
    })
}
