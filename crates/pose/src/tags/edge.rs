//! Fit of one blurred straight edge to the pixels of a band about it.

use nalgebra::{SMatrix, SVector};
use palette::encoding::{IntoLinear, Srgb};

use scaleproof_core::least_squares::{LeastSquares, Limits, minimise};
use scaleproof_core::statistics::normal::fast_normal_cdf_and_density;

/// Position of an edge relative to the first guess: `offset + slope · along` px across it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Edge {
    pub offset: f64,
    pub slope: f64,
    pub profile: EdgeProfile,
}

/// Brightness profile of the pixels across an edge.
#[derive(Debug, Clone, Copy)]
pub(super) struct EdgeProfile {
    /// Standard deviation of the blur, px.
    pub blur: f64,
    /// Linear light on either side, 0–1.
    outside: f64,
    inside: f64,
}

/// Difference of light between the two sides below which there is no edge, full scale 1.
const MIN_CONTRAST: f64 = 0.02;

/// Root mean square residual, as a share of the contrast, above which the pixels do not show a single straight edge.
const MAX_MISFIT: f64 = 0.15;

const LIMITS: Limits = Limits {
    first_damping: 1e-3,
    most_trials: 12,
    relative_gain: 1e-5,
    absolute_gain: 0.0,
};

/// Offset (px), slope (px), blur (px, standard deviation), light outside and inside (0–1).
type Parameters = SVector<f64, 5>;

/// Fits light = outside + (inside − outside) · Φ((across − offset − slope · along) / blur), Φ the normal distribution. `None` if there is no such
/// edge in the band of half width `band`, px. `guess`: from an earlier fit, which saves steps.
pub(super) fn fit(pixels: &BandPixels, band: f64, guess: Option<EdgeProfile>) -> Option<Edge> {
    let EdgeProfile { blur, outside, inside } = guess.or_else(|| pixels.first_guess(band))?;
    let start = Parameters::from([0.0, 0.0, blur, outside, inside]);
    let fitted = minimise(EdgeEquations::at(start, pixels, band), &LIMITS);
    let [offset, slope, blur, outside, inside] = fitted.parameters.into();
    let contrast = (inside - outside).abs();
    let misfit = (fitted.cost / pixels.light.len() as f64).sqrt();
    let seen =
        contrast > MIN_CONTRAST && misfit < MAX_MISFIT * contrast && blur < band && offset.abs() + slope.abs() < band;
    let profile = EdgeProfile { blur, outside, inside };
    seen.then_some(Edge { offset, slope, profile })
}

/// Pixels of a band, as one list for each quantity, so that several are computed per instruction. Single precision is 4 parts in 10⁸ of full light, a
/// step of a photo's 256 is 4 parts in 10³.
#[derive(Default)]
pub(super) struct BandPixels {
    along: Vec<f32>,
    across: Vec<f32>,
    light: Vec<f32>,
}

impl BandPixels {
    /// Adds a pixel: its position along the first guess of the edge, from −1 to 1, and across it, px, positive inside the tag; its grey level as
    /// stored.
    pub(super) fn push(&mut self, along: f64, across: f64, level: u8) {
        self.along.push(along as f32);
        self.across.push(across as f32);
        self.light.push(linear_light()[usize::from(level)]);
    }

    /// Guesses the profile from the two outer thirds of the band; `None` without pixels on both sides.
    fn first_guess(&self, band: f64) -> Option<EdgeProfile> {
        let mean = |side: f64| {
            let far = self.across.iter().zip(&self.light);
            let far = far.filter(|(across, _)| f64::from(**across) * side > band / 3.0);
            let (count, sum) = far.fold((0, 0.0), |(n, sum), (_, light)| (n + 1, sum + f64::from(*light)));
            (count > 0).then(|| sum / f64::from(count))
        };
        Some(EdgeProfile {
            blur: (band / 3.0).max(0.5),
            outside: mean(-1.0)?,
            inside: mean(1.0)?,
        })
    }

    fn sums(&self, parameters: &Parameters) -> Sums {
        let whole = self.light.len() / LANES * LANES;
        let lists = [&self.along, &self.across, &self.light].map(|list| list.split_at(whole));
        let many = sums_of_many(lists.map(|(many, _)| many), parameters);
        let rest = sums_by::<1>(lists.map(|(_, rest)| rest), parameters);
        std::array::from_fn(|i| std::array::from_fn(|j| many[i][j] + rest[i][j]))
    }
}

/// Number of pixels summed in parallel (SIMD lanes).
const LANES: usize = 8;

/// Sums for the normal equations. With the density d and the share s = Φ at a pixel, its place a along and u across, and its misfit r: the sums of
/// d², d²a, d²u, (da)², d²au, (du)², d, da, du, ds, das, dus, s, s², rd, rda, rdu, r, rs, r².
type Sums = [[f64; 5]; 4];

/// Computes the [`Sums`] of the pixels, N at a time.
#[inline(always)]
fn sums_by<const N: usize>([along, across, light]: [&[f32]; 3], parameters: &Parameters) -> Sums {
    let [offset, slope, blur, outside, inside] = (*parameters).map(|p| p as f32).into();
    let (per_blur, contrast) = (1.0 / blur, inside - outside);
    let mut sums = [[[0.0; N]; 5]; 4];
    let lists = along.as_chunks::<N>().0.iter().zip(across.as_chunks::<N>().0);
    for ((a, across), light) in lists.zip(light.as_chunks::<N>().0) {
        let u: [f32; N] = std::array::from_fn(|i| (across[i] - offset - slope * a[i]) * per_blur);
        let (s, d) = fast_normal_cdf_and_density(u);
        let r: [f32; N] = std::array::from_fn(|i| light[i] - outside - contrast * s[i]);
        let (da, du) = (times(d, *a), times(d, u));
        let terms = [
            [times(d, d), times(d, da), times(d, du), times(da, da), times(da, du)],
            [times(du, du), d, da, du, times(d, s)],
            [times(da, s), times(du, s), s, times(s, s), times(r, d)],
            [times(r, da), times(r, du), r, times(r, s), times(r, r)],
        ];
        for (sum, term) in sums.as_flattened_mut().iter_mut().zip(terms.as_flattened()) {
            for i in 0..N {
                sum[i] += term[i];
            }
        }
    }
    sums.map(|row| row.map(|lanes| lanes.into_iter().map(f64::from).sum()))
}

#[inline(always)]
fn times<const N: usize>(a: [f32; N], b: [f32; N]) -> [f32; N] {
    std::array::from_fn(|i| a[i] * b[i])
}

scaleproof_core::by_avx2! {
    /// Computes the [`Sums`] of the pixels, `LANES` at a time.
    fn sums_of_many(lists: [&[f32]; 3], parameters: &Parameters) -> Sums {
        sums_by::<LANES>(lists, parameters)
    }
}

struct EdgeEquations<'a> {
    parameters: Parameters,
    information: SMatrix<f64, 5, 5>,
    /// Jᵀr of the misfit r = light − model.
    gradient: Parameters,
    cost: f64,
    pixels: &'a BandPixels,
    band: f64,
}

impl<'a> EdgeEquations<'a> {
    /// Builds the normal equations; a pixel's derivatives are t, ta, tu, 1 − s and s, with t = −(inside − outside) · d / blur.
    fn at(parameters: Parameters, pixels: &'a BandPixels, band: f64) -> EdgeEquations<'a> {
        let [_, _, blur, outside, inside] = parameters.into();
        let t = -(inside - outside) / blur;
        let [first, second, third, fourth] = pixels.sums(&parameters);
        let ([dd, dda, ddu, dada, dadu], [dudu, d, da, du, ds]) = (first, second);
        let ([das, dus, s, ss, rd], [rda, rdu, r, rs, rr]) = (third, fourth);
        let count = pixels.light.len() as f64;
        let rows = [
            [t * t * dd, 0.0, 0.0, 0.0, 0.0],
            [t * t * dda, t * t * dada, 0.0, 0.0, 0.0],
            [t * t * ddu, t * t * dadu, t * t * dudu, 0.0, 0.0],
            [t * (d - ds), t * (da - das), t * (du - dus), count - 2.0 * s + ss, 0.0],
            [t * ds, t * das, t * dus, s - ss, ss],
        ];
        let mut information = SMatrix::<f64, 5, 5>::from_fn(|i, j| rows[i][j]);
        information.fill_upper_triangle_with_lower_triangle();
        EdgeEquations {
            parameters,
            information,
            gradient: Parameters::from([t * rd, t * rda, t * rdu, r - rs, rs]),
            cost: rr,
            pixels,
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
        Some(EdgeEquations::at(next, self.pixels, self.band))
    }
}

/// Returns the linear light of each stored level, 0–1 (IEC 61966-2-1, sRGB).
fn linear_light() -> &'static [f32; 256] {
    static TABLE: std::sync::LazyLock<[f32; 256]> = std::sync::LazyLock::new(|| {
        // Not `palette`'s own table of 8-bit levels, which is exact to 7e-7 only.
        let light = |level| -> f64 { Srgb::into_linear(level as f64 / 255.0) };
        std::array::from_fn(|level| light(level) as f32)
    });
    &TABLE
}
