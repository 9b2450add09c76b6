//! The light on the paper: how bright bare paper is at each place of the chart, per channel.
//!
//! Gain, white balance, fall-off and vignetting are one thing here: the logarithm of the white is a polynomial of the place. The
//! plane is taken unless the quadratic surface says the whites better that it was not fitted to (leave-one-out, by the hat
//! matrix: Allen 1974, PRESS).

use nalgebra::{DMatrix, DVector};

/// The quadratic surface must lower the left-out error to this share of the plane's.
const WORTH: f64 = 0.8;

/// Which surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Surface {
    Plane,
    Quadratic,
}

/// The white of the paper over the chart.
#[derive(Debug, Clone, PartialEq)]
pub struct ChartLight {
    pub surface: Surface,
    /// Root mean square of what the left-out whites differ from the surface, as a share of the light.
    pub error: f64,
    /// Each white's difference from the surface fitted without it, as a share of the light; the largest of its channels.
    pub off: Vec<f64>,
    /// The chart's middle, which is half its size, mm.
    middle: [f64; 2],
    /// Per channel, in the order of [`terms`].
    coefficients: [Vec<f64>; 3],
}

impl ChartLight {
    /// Fits the light to whites: place (mm, chart frame) and light, all positive. `None` with fewer than 8 of them.
    pub fn fit(whites: &[([f64; 2], [f64; 3])], (width_mm, height_mm): (f64, f64)) -> Option<Self> {
        if whites.len() < 8 || whites.iter().any(|(_, light)| light.iter().any(|v| *v <= 0.0)) {
            return None;
        }
        let middle = [width_mm / 2.0, height_mm / 2.0];
        let plane = Self::of(Surface::Plane, whites, middle)?;
        let quadratic = Self::of(Surface::Quadratic, whites, middle)?;
        Some(if quadratic.error < WORTH * plane.error {
            quadratic
        } else {
            plane
        })
    }

    /// The light of bare paper at a place (mm, chart frame).
    pub fn at(&self, place: [f64; 2]) -> [f64; 3] {
        let terms = terms(self.surface, place, self.middle);
        [0, 1, 2].map(|channel| {
            let sum: f64 = self.coefficients[channel].iter().zip(&terms).map(|(c, t)| c * t).sum();
            sum.exp()
        })
    }

    fn of(surface: Surface, whites: &[([f64; 2], [f64; 3])], middle: [f64; 2]) -> Option<Self> {
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

/// 1, x, y, and of the quadratic surface x², xy, y²; x and y from −1 to 1 over the chart.
fn terms(surface: Surface, [x, y]: [f64; 2], middle: [f64; 2]) -> Vec<f64> {
    let (x, y) = (x / middle[0] - 1.0, y / middle[1] - 1.0);
    match surface {
        Surface::Plane => vec![1.0, x, y],
        Surface::Quadratic => vec![1.0, x, y, x * x, x * y, y * y],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn whites(light: impl Fn(f64, f64) -> f64) -> Vec<([f64; 2], [f64; 3])> {
        let places = (0..35).map(|i| [f64::from(i % 5) * 40.0, f64::from(i / 5) * 30.0]);
        // A pattern of ±0.3 % stands for noise.
        let noise = |[x, y]: [f64; 2]| 1.0 + 0.003 * (3.7 * x + 1.9 * y).sin();
        places
            .map(|p| (p, [0.6, 0.5, 0.4].map(|gain| gain * light(p[0], p[1]) * noise(p))))
            .collect()
    }

    #[test]
    fn light_that_falls_off_evenly_is_a_plane() {
        let light = |x: f64, y: f64| (0.002 * x - 0.001 * y).exp();
        let fit = ChartLight::fit(&whites(light), (176.0, 198.0)).unwrap();
        assert_eq!(fit.surface, Surface::Plane);
        let [r, _, b] = fit.at([33.0, 77.0]);
        assert!((r / (0.6 * light(33.0, 77.0)) - 1.0).abs() < 0.003, "{r}");
        assert!((b / (0.4 * light(33.0, 77.0)) - 1.0).abs() < 0.003, "{b}");
    }

    #[test]
    fn vignetting_is_worth_the_larger_surface() {
        let light = |x: f64, y: f64| 1.0 - 1e-5 * ((x - 80.0).powi(2) + (y - 90.0).powi(2));
        let fit = ChartLight::fit(&whites(light), (176.0, 198.0)).unwrap();
        assert_eq!(fit.surface, Surface::Quadratic);
        assert!((fit.at([20.0, 20.0])[1] / (0.5 * light(20.0, 20.0)) - 1.0).abs() < 0.01);
    }

    #[test]
    fn a_white_in_a_shadow_stands_out() {
        let mut shaded = whites(|_, _| 1.0);
        shaded[17].1 = shaded[17].1.map(|v| 0.8 * v);
        let fit = ChartLight::fit(&shaded, (176.0, 198.0)).unwrap();
        let worst = (0..35).max_by(|a, b| fit.off[*a].total_cmp(&fit.off[*b]));
        assert_eq!(worst, Some(17));
        assert!(fit.off[17] > 0.2);
        assert!(ChartLight::fit(&shaded[..7], (176.0, 198.0)).is_none());
    }
}
