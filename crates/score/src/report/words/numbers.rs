//! Numbers in texts for people.

use scaleproof_core::spelling::digits;

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
