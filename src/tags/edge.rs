//! One blurred straight edge, fitted to the pixels of a band about it.

use nalgebra::{SMatrix, SVector};
use palette::encoding::{IntoLinear, Srgb};

use crate::least_squares::{LeastSquares, Limits, minimise};
use crate::statistics::normal::fast_cdf_and_density;

/// One pixel of the band.
#[derive(Debug, Clone, Copy)]
pub(super) struct EdgePixel {
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

const LIMITS: Limits = Limits {
    first_damping: 1e-3,
    most_trials: 12,
    relative_gain: 1e-6,
    absolute_gain: 0.0,
};

/// Offset (px), slope (px), blur (px, standard deviation), light outside and inside (0–1).
type Parameters = SVector<f64, 5>;

/// Fits light = outside + (inside − outside) · Φ((across − offset − slope · along) / blur), Φ the normal distribution.
/// `None` when there is no such edge in the band of half width `band`, px.
pub(super) fn fit(samples: &[EdgePixel], band: f64) -> Option<Edge> {
    let light = linear_light();
    let values: Vec<f64> = samples.iter().map(|s| light[usize::from(s.level)]).collect();
    let start = first_guess(samples, &values, band)?;
    let fitted = minimise(EdgeEquations::at(start, samples, &values, band), &LIMITS);
    let [offset, slope, blur, outside, inside] = fitted.parameters.into();
    let contrast = (inside - outside).abs();
    let misfit = (fitted.cost / samples.len() as f64).sqrt();
    let seen =
        contrast > MIN_CONTRAST && misfit < MAX_MISFIT * contrast && blur < band && offset.abs() + slope.abs() < band;
    seen.then_some(Edge { offset, slope, blur })
}

/// Levels from the two outer thirds of the band; `None` without pixels on both sides.
fn first_guess(samples: &[EdgePixel], values: &[f64], band: f64) -> Option<Parameters> {
    let mean = |side: f64| {
        let far = samples.iter().zip(values).filter(|(s, _)| s.across * side > band / 3.0);
        let (count, sum) = far.fold((0, 0.0), |(n, sum), (_, v)| (n + 1, sum + v));
        (count > 0).then(|| sum / f64::from(count))
    };
    Some(Parameters::from([
        0.0,
        0.0,
        (band / 3.0).max(0.5),
        mean(-1.0)?,
        mean(1.0)?,
    ]))
}

/// The normal equations of all pixels for one edge.
struct EdgeEquations<'a> {
    parameters: Parameters,
    /// JᵀJ.
    information: SMatrix<f64, 5, 5>,
    /// Jᵀr of the misfit r = value − model.
    gradient: Parameters,
    cost: f64,
    samples: &'a [EdgePixel],
    values: &'a [f64],
    band: f64,
}

impl<'a> EdgeEquations<'a> {
    fn at(parameters: Parameters, samples: &'a [EdgePixel], values: &'a [f64], band: f64) -> EdgeEquations<'a> {
        let [offset, slope, blur, outside, inside] = parameters.into();
        let (mut information, mut gradient, mut cost) = (SMatrix::<f64, 5, 5>::zeros(), Parameters::zeros(), 0.0);
        for (s, value) in samples.iter().zip(values) {
            let u = (s.across - offset - slope * s.along) / blur;
            let (share, density) = fast_cdf_and_density(u);
            let towards = -(inside - outside) * density / blur;
            let j = [towards, towards * s.along, towards * u, 1.0 - share, share];
            let r = value - outside - (inside - outside) * share;
            cost += r * r;
            for a in 0..5 {
                gradient[a] += j[a] * r;
                for b in a..5 {
                    information[(b, a)] += j[a] * j[b];
                }
            }
        }
        information.fill_upper_triangle_with_lower_triangle();
        EdgeEquations {
            parameters,
            information,
            gradient,
            cost,
            samples,
            values,
            band,
        }
    }
}

impl LeastSquares for EdgeEquations<'_> {
    fn cost(&self) -> f64 {
        self.cost
    }

    fn stepped(&self, damping: f64) -> Option<Self> {
        let mut damped = self.information;
        (0..5).for_each(|i| damped[(i, i)] *= 1.0 + damping);
        let mut next = self.parameters + damped.cholesky()?.solve(&self.gradient);
        next[2] = next[2].clamp(0.2, 2.0 * self.band);
        Some(EdgeEquations::at(next, self.samples, self.values, self.band))
    }
}

/// The light behind each stored level, 0–1 (IEC 61966-2-1, sRGB).
fn linear_light() -> &'static [f64; 256] {
    static TABLE: std::sync::LazyLock<[f64; 256]> = std::sync::LazyLock::new(|| {
        // Not `palette`'s own table of 8-bit levels, which is exact to 7e-7 only.
        std::array::from_fn(|level| Srgb::into_linear(level as f64 / 255.0))
    });
    &TABLE
}
