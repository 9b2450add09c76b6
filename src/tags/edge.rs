//! One blurred straight edge, fitted to the pixels of a band about it.

use nalgebra::{SMatrix, SVector};

/// One pixel of the band.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    /// Along the first guess of the edge, from −1 to 1.
    pub along: f64,
    /// Across it, px; positive inside the tag.
    pub across: f64,
    /// Grey level as stored.
    pub level: u8,
}

/// Where the edge is: `offset + slope · along` px across the first guess.
#[derive(Debug, Clone, Copy)]
pub(super) struct Edge {
    pub offset: f64,
    pub slope: f64,
    /// Standard deviation of the blur across it, px.
    pub blur: f64,
}

/// Difference of light between the two sides below which there is no edge, full scale 1.
const MIN_CONTRAST: f64 = 0.02;

/// Root mean square misfit, as a share of the contrast, above which the pixels show something else than one straight edge.
const MAX_MISFIT: f64 = 0.15;

const MAX_STEPS: usize = 12;

/// Offset (px), slope (px), blur (px, standard deviation), light outside and inside (0–1).
type Model = SVector<f64, 5>;

/// Fits light = outside + (inside − outside) · Φ((across − offset − slope · along) / blur), Φ the normal distribution, by
/// Levenberg–Marquardt. `None` when there is no such edge in the band of half width `band`, px.
pub(super) fn fit(samples: &[Sample], band: f64) -> Option<Edge> {
    let light = linear_light();
    let values: Vec<f64> = samples.iter().map(|s| light[usize::from(s.level)]).collect();
    let mut model = first_guess(samples, &values, band)?;
    let (mut normal, mut gradient, mut cost) = normal_equations(samples, &values, &model);
    let mut damping = 1e-3;
    for _ in 0..MAX_STEPS {
        let mut damped = normal;
        (0..5).for_each(|i| damped[(i, i)] *= 1.0 + damping);
        let step = damped.cholesky()?.solve(&gradient);
        let mut next = model + step;
        next[2] = next[2].clamp(0.2, 2.0 * band);
        let (next_normal, next_gradient, next_cost) = normal_equations(samples, &values, &next);
        if next_cost <= cost {
            let done = cost - next_cost <= 1e-6 * cost;
            (model, normal, gradient, cost) = (next, next_normal, next_gradient, next_cost);
            damping *= 0.1;
            if done {
                break;
            }
        } else {
            damping *= 10.0;
        }
    }
    let [offset, slope, blur, outside, inside] = model.into();
    let contrast = (inside - outside).abs();
    let misfit = (cost / samples.len() as f64).sqrt();
    let seen =
        contrast > MIN_CONTRAST && misfit < MAX_MISFIT * contrast && blur < band && offset.abs() + slope.abs() < band;
    seen.then_some(Edge { offset, slope, blur })
}

/// Levels from the two outer thirds of the band; `None` without pixels on both sides.
fn first_guess(samples: &[Sample], values: &[f64], band: f64) -> Option<Model> {
    let mean = |side: f64| {
        let far = samples.iter().zip(values).filter(|(s, _)| s.across * side > band / 3.0);
        let (count, sum) = far.fold((0, 0.0), |(n, sum), (_, v)| (n + 1, sum + v));
        (count > 0).then(|| sum / f64::from(count))
    };
    Some(Model::from([0.0, 0.0, (band / 3.0).max(0.5), mean(-1.0)?, mean(1.0)?]))
}

/// JᵀJ, Jᵀr and rᵀr of the misfit r = value − model.
fn normal_equations(samples: &[Sample], values: &[f64], model: &Model) -> (SMatrix<f64, 5, 5>, Model, f64) {
    let [offset, slope, blur, outside, inside] = (*model).into();
    let (mut normal, mut gradient, mut cost) = (SMatrix::<f64, 5, 5>::zeros(), Model::zeros(), 0.0);
    for (s, value) in samples.iter().zip(values) {
        let u = (s.across - offset - slope * s.along) / blur;
        let (share, density) = normal_distribution(u);
        let towards = -(inside - outside) * density / blur;
        let j = [towards, towards * s.along, towards * u, 1.0 - share, share];
        let r = value - outside - (inside - outside) * share;
        cost += r * r;
        for a in 0..5 {
            gradient[a] += j[a] * r;
            for b in a..5 {
                normal[(b, a)] += j[a] * j[b];
            }
        }
    }
    for a in 0..5 {
        for b in a + 1..5 {
            normal[(a, b)] = normal[(b, a)];
        }
    }
    (normal, gradient, cost)
}

/// Φ(u) and its derivative (Abramowitz & Stegun 26.2.17, absolute error below 7.5e-8).
fn normal_distribution(u: f64) -> (f64, f64) {
    const B: [f64; 5] = [0.319381530, -0.356563782, 1.781477937, -1.821255978, 1.330274429];
    const PER_SQRT_TAU: f64 = 0.398_942_280_401_432_7;
    let density = PER_SQRT_TAU * (-0.5 * u * u).exp();
    let t = 1.0 / (1.0 + 0.2316419 * u.abs());
    let tail = density * t * (B[0] + t * (B[1] + t * (B[2] + t * (B[3] + t * B[4]))));
    (if u < 0.0 { tail } else { 1.0 - tail }, density)
}

/// The light behind each stored level, 0–1 (IEC 61966-2-1, sRGB).
fn linear_light() -> &'static [f64; 256] {
    static TABLE: std::sync::LazyLock<[f64; 256]> = std::sync::LazyLock::new(|| {
        std::array::from_fn(|level| {
            let v = level as f64 / 255.0;
            if v <= 0.04045 {
                v / 12.92
            } else {
                ((v + 0.055) / 1.055).powf(2.4)
            }
        })
    });
    &TABLE
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_normal_distribution_is_the_tabled_one() {
        for (u, share) in [(0.0, 0.5), (1.0, 0.841344746), (-1.0, 0.158655254), (2.5, 0.993790335)] {
            assert!((normal_distribution(u).0 - share).abs() < 1e-7);
        }
    }
}
