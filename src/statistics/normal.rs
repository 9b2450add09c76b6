//! The standard normal distribution.

use std::sync::LazyLock;

use statrs::function::erf::erfc;

/// 95 % of the distribution lies within this distance of 0.
pub(crate) const TWO_SIDED_95: f64 = 1.959963984540054;

/// The probability that a standard normal variable is above `z`.
pub(crate) fn upper_tail(z: f64) -> f64 {
    erfc(z / std::f64::consts::SQRT_2) / 2.0
}

/// The probability that a normal variable lies between two values.
pub(crate) fn between(from: f64, to: f64, mean: f64, sigma: f64) -> f64 {
    upper_tail((from - mean) / sigma) - upper_tail((to - mean) / sigma)
}

/// Φ(u) and its derivative, for fits that need both of every pixel: Taylor series about the nearest node of a table, within 1e-7.
#[inline(always)]
pub(crate) fn fast_cdf_and_density(u: f64) -> (f64, f64) {
    let inside = u.clamp(-END, END);
    let index = ((inside + END) * STEPS + 0.5) as usize;
    let Some((cdf, density)) = NODES.get(index) else {
        return (f64::NAN, f64::NAN); // of no number
    };
    let node = index as f64 / STEPS - END;
    let d = inside - node;
    // The derivatives of the density are the density times −u, u² − 1, and so on.
    let bend = 0.5 * d * d * (node * node - 1.0);
    (
        cdf + density * d * (1.0 - 0.5 * d * node + bend / 3.0),
        density * (1.0 - d * node + bend),
    )
}

/// Beyond, nothing is left within double precision of what a fit can tell.
const END: f64 = 6.5;

/// Nodes a unit.
const STEPS: f64 = 64.0;

/// The distribution and its density at the nodes.
static NODES: LazyLock<Vec<(f64, f64)>> = LazyLock::new(|| {
    let at = |index: i32| {
        let u = f64::from(index) / STEPS - END;
        (upper_tail(-u), (-0.5 * u * u).exp() / std::f64::consts::TAU.sqrt())
    };
    (0..=(2.0 * END * STEPS) as i32).map(at).collect()
});

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_normal_distribution_is_the_tabled_one() {
        for (u, share) in [(0.0, 0.5), (1.0, 0.841344746), (-1.0, 0.158655254), (2.5, 0.993790335)] {
            assert!((upper_tail(-u) - share).abs() < 1e-9);
            assert!((fast_cdf_and_density(u).0 - share).abs() < 1e-7);
        }
        assert!((upper_tail(TWO_SIDED_95) - 0.025).abs() < 1e-11);
        for step in -600..=600 {
            let u = f64::from(step) / 100.0;
            assert!((fast_cdf_and_density(u).0 - upper_tail(-u)).abs() < 7.5e-8, "{u}");
        }
    }
}
