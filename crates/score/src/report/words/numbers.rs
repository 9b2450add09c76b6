//! Numbers in texts for people.

use scaleproof_core::spelling::digits;
use scaleproof_core::statistics::Interval;

/// Formats a number with `behind` digits behind the point, and a true minus sign.
pub fn number(value: f64, behind: usize) -> String {
    digits(value, behind).replace('-', "−")
}

/// Formats a p value with its sign, to stand behind `p`.
pub fn p_value(p: f64) -> String {
    match digits(p, 3) {
        _ if p < 0.001 => "< 0.001".to_owned(),
        // Rounded to 0.050 it would look like a difference that is shown.
        shown if shown == "0.050" && p > 0.05 => "> 0.050".to_owned(),
        shown => format!("= {shown}"),
    }
}

/// Writes an interval as `[0.38, 1.00]`, its numbers by `number`.
pub(crate) fn bracketed(interval: Interval, number: impl Fn(f64) -> String) -> String {
    format!("[{}, {}]", number(interval.low), number(interval.high))
}
