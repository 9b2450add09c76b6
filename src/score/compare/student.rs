//! Student's t for whole degrees of freedom.

/// The t that 95 % of the distribution lies within, either side of 0. `freedom` is at least 1.
pub(super) fn two_sided_95(freedom: usize) -> f64 {
    let (mut low, mut high) = (1.9, 13.0);
    for _ in 0..60 {
        let middle = (low + high) / 2.0;
        if within(middle, freedom) < 0.95 {
            low = middle;
        } else {
            high = middle;
        }
    }
    (low + high) / 2.0
}

/// P(|T| < t): Abramowitz & Stegun 26.7.3 and 26.7.4.
fn within(t: f64, freedom: usize) -> f64 {
    let angle = (t / (freedom as f64).sqrt()).atan();
    let (sin, cos) = angle.sin_cos();
    let odd = freedom % 2 == 1;
    // cos θ · (1 + 2/3 cos² θ + …) for odd degrees, 1 + 1/2 cos² θ + … for even ones.
    let (mut term, mut sum) = (if odd { cos } else { 1.0 }, 0.0);
    let mut power = if odd { 1 } else { 0 };
    while power + 2 <= freedom {
        sum += term;
        term *= cos * cos * (power + 1) as f64 / (power + 2) as f64;
        power += 2;
    }
    if odd {
        (angle + sin * sum) * std::f64::consts::FRAC_2_PI
    } else {
        sin * sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_printed_table() {
        for (freedom, t) in [
            (1, 12.706),
            (2, 4.303),
            (5, 2.571),
            (15, 2.131),
            (40, 2.021),
            (95, 1.985),
        ] {
            assert!(
                (two_sided_95(freedom) - t).abs() < 6e-4,
                "{freedom}: {}",
                two_sided_95(freedom)
            );
        }
    }
}
