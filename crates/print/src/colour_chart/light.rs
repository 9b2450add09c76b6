//! Illumination of the paper: the light of bare paper at each place of the chart, per channel.
//!
//! Gain, white balance, fall-off and vignetting are modelled together: the logarithm of the white is a polynomial of the place. The plane is used
//! unless the quadratic surface predicts left-out whites better (leave-one-out, by the hat matrix: Allen 1974, PRESS).

use nalgebra::{DMatrix, DVector};

/// Maximum ratio of the quadratic surface's left-out error to the plane's for it to be used.
const WORTH: f64 = 0.8;

/// The kind of surface that is fitted to the light.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Surface {
    Plane,
    Quadratic,
}

#[derive(Debug, Clone, PartialEq)]
pub struct ChartLight {
    pub surface: Surface,
    /// Root mean square of what the left-out whites differ from the surface, as a share of the light.
    pub error: f64,
    /// Each white's difference from the surface fitted without it, as a share of the light; the largest of its channels.
    pub off: Vec<f64>,
    /// Centre of the chart, mm: half its size.
    middle: [f64; 2],
    /// Coefficients per channel, in the order of [`terms`].
    coefficients: [Vec<f64>; 3],
}

impl ChartLight {
    /// Fits the light to whites: place (mm, chart frame) and light, all positive. `None` for fewer than 8 of them.
    pub fn fit(whites: &[([f64; 2], [f64; 3])], (width_mm, height_mm): (f64, f64)) -> Option<Self> {
        if whites.len() < 8 || whites.iter().any(|(_, light)| light.iter().any(|v| *v <= 0.0)) {
            return None;
        }
        let middle = [width_mm / 2.0, height_mm / 2.0];
        let plane = Self::fit_surface(Surface::Plane, whites, middle)?;
        let quadratic = Self::fit_surface(Surface::Quadratic, whites, middle)?;
        Some(if quadratic.error < WORTH * plane.error {
            quadratic
        } else {
            plane
        })
    }

    /// Returns the light of bare paper at a place (mm, chart frame).
    pub fn at(&self, place: [f64; 2]) -> [f64; 3] {
        let terms = terms(self.surface, place, self.middle);
        [0, 1, 2].map(|channel| {
            let products = self.coefficients[channel].iter().zip(&terms).map(|(c, t)| c * t);
            products.sum::<f64>().exp()
        })
    }

    fn fit_surface(surface: Surface, whites: &[([f64; 2], [f64; 3])], middle: [f64; 2]) -> Option<Self> {
        let rows: Vec<Vec<f64>> = whites.iter().map(|(place, _)| terms(surface, *place, middle)).collect();
        let design = DMatrix::from_fn(rows.len(), rows[0].len(), |row, column| rows[row][column]);
        let inverse = (design.transpose() * &design).try_inverse()?;
        let solve = inverse * design.transpose();
        let hat = &design * &solve;
        let mut off = vec![0.0_f64; whites.len()];
        let mut squares = 0.0;
        let coefficients = [0, 1, 2].map(|channel| {
            let logs = DVector::from_fn(whites.len(), |i, _| whites[i].1[channel].ln());
            let solution = &solve * &logs;
            let left = &logs - &design * &solution;
            for (i, off) in off.iter_mut().enumerate() {
                let left_out = left[i] / (1.0 - hat[(i, i)]);
                squares += left_out * left_out;
                *off = off.max(left_out.abs());
            }
            solution.iter().copied().collect()
        });
        Some(Self {
            surface,
            error: (squares / (3 * whites.len()) as f64).sqrt(),
            off,
            middle,
            coefficients,
        })
    }
}

/// Returns the polynomial terms 1, x, y, and for the quadratic surface x², xy, y²; x and y from −1 to 1 over the chart.
fn terms(surface: Surface, [x, y]: [f64; 2], middle: [f64; 2]) -> Vec<f64> {
    let (x, y) = (x / middle[0] - 1.0, y / middle[1] - 1.0);
    match surface {
        Surface::Plane => vec![1.0, x, y],
        Surface::Quadratic => vec![1.0, x, y, x * x, x * y, y * y],
    }
}
