//! Angles in degrees, the unit of every boundary of this program.

/// Wraps a direction in degrees to [0, 360).
pub fn wrap_360(deg: f64) -> f64 {
    let wrapped = deg.rem_euclid(360.0);
    // rem_euclid of a tiny negative number rounds up to 360 itself.
    if wrapped >= 360.0 { 0.0 } else { wrapped }
}

/// Formats a direction with a number of decimals; what rounds to 360 is 0.
pub fn direction_text(deg: f64, decimals: usize) -> String {
    let unit = 10f64.powi(decimals as i32);
    format!("{:.decimals$}", wrap_360((deg * unit).round() / unit))
}

/// Returns the signed turn from `from` to `to`, in [-180, 180).
pub fn turn(from: f64, to: f64) -> f64 {
    wrap_360(to - from + 180.0) - 180.0
}
