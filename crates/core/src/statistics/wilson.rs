//! The Wilson score interval of a rate (Wilson 1927).

use super::normal::TWO_SIDED_95 as Z;

/// 95 % interval of `hits` out of `n`; `None` for n = 0.
pub fn wilson_95(hits: usize, n: usize) -> Option<(f64, f64)> {
    if n == 0 {
        return None;
    }
    let (n, p) = (n as f64, hits as f64 / n as f64);
    let centre = p + Z * Z / (2.0 * n);
    let half = Z * (p * (1.0 - p) / n + Z * Z / (4.0 * n * n)).sqrt();
    let scale = 1.0 + Z * Z / n;
    Some((((centre - half) / scale).max(0.0), ((centre + half) / scale).min(1.0)))
}
