//! Bounds of the lengths that users give. Each length passes here before anything is computed with it, so that nothing behind
//! meets a number that is none, leaves the range of its integers, or divides by almost nothing.

use std::ops::RangeInclusive;

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
    /// As [`shown`].
    value: String,
    least: f64,
    most: f64,
}

/// The size of a thing. `what` begins the sentence of a refusal.
pub fn size_mm(what: &str, value: f64) -> Result<f64, BadLength> {
    within(what, value, SHORTEST_MM..=LONGEST_MM)
}

/// A strip or a distance that may be 0.
pub fn strip_mm(what: &str, value: f64) -> Result<f64, BadLength> {
    within(what, value, 0.0..=LONGEST_MM)
}

/// A glue tab: wide enough to hold, narrow enough to fold.
pub fn tab_mm(value: f64) -> Result<f64, BadLength> {
    within("a glue tab", value, 4.0..=15.0)
}

/// A coordinate, which may be negative.
pub fn place_mm(what: &str, value: f64) -> Result<f64, BadLength> {
    within(what, value, -LONGEST_MM..=LONGEST_MM)
}

/// Whether [`size_mm`] takes it, for those who refuse it in words of their own.
pub fn is_size(mm: f64) -> bool {
    (SHORTEST_MM..=LONGEST_MM).contains(&mm)
}

/// A number in a sentence: plain, or with an exponent where it would fill a line.
pub fn shown(value: f64) -> String {
    let is_plain = value == 0.0 || !value.is_finite() || (1e-6..1e9).contains(&value.abs());
    if is_plain {
        value.to_string()
    } else {
        format!("{value:e}")
    }
}

/// A number with up to three decimals and no trailing zeros.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_length_is_refused_in_one_short_sentence() {
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e200, -1e200, 100_000.1] {
            for check in [size_mm, strip_mm, place_mm] {
                let sentence = check("margin", value).unwrap_err().to_string();
                assert!(sentence.starts_with("margin cannot be "), "{sentence}");
                assert!(sentence.ends_with(" to 100000 mm"), "{sentence}");
                assert!(sentence.len() < 80, "{sentence}");
            }
        }
        let sentence = |value| size_mm("square", value).unwrap_err().to_string();
        assert_eq!(sentence(1e200), "square cannot be 1e200 mm; give 0.001 to 100000 mm");
        assert_eq!(sentence(0.0), "square cannot be 0 mm; give 0.001 to 100000 mm");
    }

    #[test]
    fn sizes_are_there_strips_may_be_missing_and_places_have_two_sides() {
        assert!(
            [0.0, -0.0, -1.0, 1e-300]
                .iter()
                .all(|mm| size_mm("", *mm).is_err() && !is_size(*mm))
        );
        assert!(
            [0.001, 455.0, 1e5]
                .iter()
                .all(|mm| size_mm("", *mm) == Ok(*mm) && is_size(*mm))
        );
        assert!(strip_mm("", -0.5).is_err() && strip_mm("", 1e-300).is_ok());
        assert_eq!(place_mm("", -1e5), Ok(-1e5));
        assert!(
            strip_mm("", -0.0).is_ok_and(f64::is_sign_positive),
            "no minus before a zero"
        );
    }

    #[test]
    fn numbers_are_plain_where_that_is_short() {
        let plain = [0.0, -118.0, 0.01, 1e6, f64::NAN].map(shown);
        assert_eq!(plain, ["0", "-118", "0.01", "1000000", "NaN"]);
        assert_eq!([1e200, -1e-300].map(shown), ["1e200", "-1e-300"]);
        assert_eq!([118.0, 7.375, 0.1 + 0.2].map(number), ["118", "7.375", "0.3"]);
    }
}
