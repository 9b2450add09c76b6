//! A polynomial per pixel and channel, in sRGB or in light.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::DMatrix;

use super::tone::{Tone, minimise};
use super::{FlatImage, Renderer};
use crate::light;
use scaleproof_core::message::{Message, bail, ensure};

/// More images than bits in [`Used`] would not fit, and are of no use.
const MOST_IMAGES: usize = 32;
/// Most values, about, that the tone curve is fitted to.
const CURVE_VALUES: usize = 6_000;
/// 8-bit level that may be clipped.
const CLIPPED: u8 = 255;

/// Images that a fit uses, as bits.
type Used = u32;

/// Closed form of a surrogate renderer. The default is the most accurate of `attack chart`; where only two colours are at hand, `affine-curve` is.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ClosedForm {
    Affine,
    Quadratic,
    AffineCurve,
    #[default]
    QuadraticCurve,
}

impl ClosedForm {
    pub const ALL: [Self; 4] = [Self::Affine, Self::Quadratic, Self::AffineCurve, Self::QuadraticCurve];

    /// Returns the name, as in options.
    pub fn name(self) -> &'static str {
        ["affine", "quadratic", "affine-curve", "quadratic-curve"][self as usize]
    }

    /// Returns the least number of colours, different in all three channels.
    pub fn least_colours(self) -> usize {
        match self {
            Self::Affine | Self::AffineCurve => 2,
            Self::Quadratic | Self::QuadraticCurve => 3,
        }
    }
}

/// Polynomial per pixel and channel.
#[derive(Debug, Clone)]
pub struct PerPixel {
    /// `None` for a polynomial in sRGB.
    tone: Option<Tone>,
    /// Constant, linear and quadratic term.
    terms: Vec<[[f64; 3]; 3]>,
}

impl PerPixel {
    /// Fits a closed form by least squares. Clipped values are left out where the others suffice: how bright they were is not known.
    ///
    /// The tone curve is the exponent with which an affine model explains the images best; it takes three colours to tell, and with two the
    /// curve is sRGB's.
    pub fn fit(kind: ClosedForm, flats: &[FlatImage]) -> Result<Self, Message> {
        let needed = kind.least_colours();
        let found = (0..3).map(|c| distinct(flats, c)).min().unwrap_or(0);
        let model = kind.name();
        if found < needed {
            bail!(
                "the {model} model needs images in {needed} flat colours that differ in every channel, and there are {found}";
                hint: "`attack render ‹flat› 000000 808080 ffffff` makes three, in a new folder"
            );
        }
        ensure!(
            flats.len() <= MOST_IMAGES,
            "more than {MOST_IMAGES} flat colours of a view are of no use; give fewer"
        );
        let size = flats[0].image.dimensions();
        let is_alike = flats.iter().all(|s| s.image.dimensions() == size);
        ensure!(
            is_alike,
            "the images of a view have different sizes; take them with the same camera"
        );
        let has_curve = matches!(kind, ClosedForm::AffineCurve | ClosedForm::QuadraticCurve);
        let tone = has_curve.then(|| fitted_tone(flats, found));
        Ok(polynomial(needed - 1, tone, flats, 1))
    }

    /// Returns the constant, linear and quadratic term of each pixel and channel, in the order of the image's rows.
    pub fn terms(&self) -> &[[[f64; 3]; 3]] {
        &self.terms
    }

    /// Returns the tone curve, where the model has one.
    pub fn tone(&self) -> Option<Tone> {
        self.tone
    }

    /// Evaluates a pixel and channel: the paint as the polynomial takes it, the polynomial's value and its derivative.
    #[inline]
    fn at(&self, index: usize, channel: usize, reflectance: f64) -> [f64; 3] {
        let [a, b, c] = self.terms[index][channel];
        let t = self.tone.map_or_else(|| light::encode(reflectance), |_| reflectance);
        [t, a + t * (b + t * c), b + 2.0 * c * t]
    }

    fn pixel(&self, index: usize, paint: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|channel| {
            let [_, y, _] = self.at(index, channel, paint[channel]);
            self.tone.map_or(y.clamp(0.0, 1.0), |tone| tone.value(y))
        })
    }

    fn pixel_derivative(&self, index: usize, paint: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|channel| {
            let [t, y, derivative] = self.at(index, channel, paint[channel]);
            match self.tone {
                Some(tone) => tone.value_derivative(y) * derivative,
                None if y <= 0.0 || y >= 1.0 => 0.0,
                None => derivative / light::decode_derivative(t),
            }
        })
    }
}

impl Renderer for PerPixel {
    fn predict(&self, paint: &[[f64; 3]]) -> Vec<[f64; 3]> {
        paint.iter().enumerate().map(|(i, p)| self.pixel(i, *p)).collect()
    }

    fn derivative(&self, paint: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let derivative = |(i, p): (usize, &[f64; 3])| self.pixel_derivative(i, *p);
        paint.iter().enumerate().map(derivative).collect()
    }
}

/// Counts different values of a channel among the images' colours.
fn distinct<'a>(flats: impl IntoIterator<Item = &'a FlatImage>, channel: usize) -> usize {
    let values = flats.into_iter().map(|flat| flat.flat_rgb[channel]);
    values.collect::<BTreeSet<u8>>().len()
}

fn fitted_tone(flats: &[FlatImage], colours: usize) -> Tone {
    if colours < 3 {
        return Tone::SRGB;
    }
    let pixels = flats[0].image.pixels().len();
    let every = (3 * pixels * flats.len()).div_ceil(CURVE_VALUES).max(1);
    let error = |power: f64| {
        let model = polynomial(1, Some(Tone { power }), flats, every);
        let mut sum = 0.0;
        for flat in flats {
            let paint = light::linear_of(flat.flat_rgb);
            for (i, (_, pixel)) in every_nth(flat, every).enumerate() {
                let predicted = model.pixel(i, paint);
                let squared = |c: usize| (predicted[c] - f64::from(pixel[c]) / 255.0).powi(2);
                sum += (0..3).map(squared).sum::<f64>();
            }
        }
        sum
    };
    Tone {
        power: minimise(Tone::POWERS, error),
    }
}

/// Every Nth pixel of an image, with its index.
fn every_nth(flat: &FlatImage, every: usize) -> impl Iterator<Item = (usize, [u8; 3])> {
    flat.image.pixels().map(|p| p.0).enumerate().step_by(every)
}

/// Fits the polynomials of every Nth pixel, in their order.
fn polynomial(degree: usize, tone: Option<Tone>, flats: &[FlatImage], every: usize) -> PerPixel {
    // 256 values have 256 lights.
    let srgb = (0..=255_u8).map(|v| f64::from(v) / 255.0);
    let values: Vec<f64> = srgb.map(|v| tone.map_or(v, |tone| tone.light(v))).collect();
    let argument = |v: u8| {
        let srgb = f64::from(v) / 255.0;
        if tone.is_some() { light::decode(srgb) } else { srgb }
    };
    let mut solvers: [BTreeMap<(Used, usize), DMatrix<f64>>; 3] = Default::default();
    let column = |flat| every_nth(flat, every).map(|(_, p)| p).collect();
    let columns: Vec<Vec<[u8; 3]>> = flats.iter().map(column).collect();
    let fit = |pixel: usize| {
        std::array::from_fn(|channel| {
            let seen: Vec<u8> = columns.iter().map(|column| column[pixel][channel]).collect();
            let (used, degree) = usable(&seen, flats, channel, degree, tone.is_some());
            let solver = solvers[channel]
                .entry((used, degree))
                .or_insert_with(|| pseudo_inverse(degree, used, flats.iter().map(|s| argument(s.flat_rgb[channel]))));
            let mut terms = [0.0; 3];
            for (term, row) in terms.iter_mut().zip(solver.row_iter()) {
                *term = row.iter().zip(&seen).map(|(w, v)| w * values[usize::from(*v)]).sum();
            }
            terms
        })
    };
    let terms = (0..columns[0].len()).map(fit).collect();
    PerPixel { tone, terms }
}

/// Chooses the images that are not clipped, and the degree they give; all images where too few would be left. A polynomial in light is lowered to a
/// line rather than bent to a clipped value; in sRGB, where a line fits badly, it is not.
fn usable(seen: &[u8], flats: &[FlatImage], channel: usize, degree: usize, is_light: bool) -> (Used, usize) {
    let all: Used = (0..flats.len()).fold(0, |bits, i| bits | 1 << i);
    if seen.iter().all(|v| *v < CLIPPED) {
        return (all, degree);
    }
    let fine = (0..flats.len()).filter(|i| seen[*i] < CLIPPED);
    let given = degree.min(distinct(fine.clone().map(|i| &flats[i]), channel).saturating_sub(1));
    if given == degree || is_light && given > 0 {
        (fine.fold(0, |bits, i| bits | 1 << i), given)
    } else {
        (all, if is_light { 1 } else { degree })
    }
}

/// Returns the matrix that makes the terms of a polynomial from the values at these arguments; columns of unused images are 0.
fn pseudo_inverse(degree: usize, used: Used, arguments: impl Iterator<Item = f64>) -> DMatrix<f64> {
    let arguments: Vec<f64> = arguments.collect();
    let design = DMatrix::from_fn(arguments.len(), degree + 1, |flat, power| {
        let is_used = used >> flat & 1 == 1;
        if is_used {
            arguments[flat].powi(power as i32)
        } else {
            0.0
        }
    });
    // Fails only for a matrix that is not finite, which arguments from 0 to 1 do not make.
    let inverse = design.pseudo_inverse(1e-12);
    inverse.unwrap_or_else(|_| DMatrix::zeros(degree + 1, arguments.len()))
}
