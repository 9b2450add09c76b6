//! Blur of a photo in its most blurred direction: from straight edges of known direction, or coarsely from all its edges.

use image::GrayImage;
use nalgebra::{Matrix2, Matrix3, SymmetricEigen, Vector3};

/// Blur by lens and pixel in the sharpest photo, px (standard deviation): 0.44 to 0.53 in the stored ones.
const LEAST_BLUR_PX: f64 = 0.4;

/// Eigenvalue of the normal matrix of the edges' directions, divided by their number, below which a direction is not determined; the smallest is ¼
/// for directions spread evenly, and 0 for those of one square.
const TOLD: f64 = 0.03;

/// Blur assumed for an edge without a fit, px: the half width of the widest band.
const UNFITTED_PX: f64 = 6.0;

/// Rounds of reweighting, and the residual (px²) below which weights are constant.
const ROUNDS: usize = 15;
const ALIKE_PX2: f64 = 0.02;

/// Blur across one side of a tag.
#[derive(Debug, Clone, Copy)]
pub struct EdgeBlur {
    /// Index of the tag among those given.
    pub tag: usize,
    /// Index of the corner at which the side begins.
    pub side: usize,
    pub normal: [f64; 2],
    /// Standard deviation across the edge, px; infinity where the edge is too blurred to be fitted.
    pub px: f64,
}

/// Returns the standard deviation of the blur in its worst direction, px; infinity if most edges are too blurred to be fitted, `None` without edges
/// of two directions.
///
/// A blur of covariance S spreads an edge of normal n by the variance nᵀSn (convolution adds variances), so S follows from edges of three directions,
/// and the worst direction is its largest eigenvector. The sum of absolute differences is minimised (iteratively reweighted least squares,
/// Schlossmacher 1973), since some edges lie in shadow or at another depth. Sides of equally oriented squares do not distinguish motion along the
/// diagonal from isotropic blur: S is then the worst that agrees with them.
pub fn worst_px(edges: &[EdgeBlur]) -> Option<f64> {
    let fitted = edges.iter().filter(|edge| edge.px.is_finite()).count();
    if 2 * fitted < edges.len() {
        return Some(f64::INFINITY);
    }
    let equations: Vec<(Vector3<f64>, f64)> = (edges.iter())
        .map(|edge| {
            let [x, y] = edge.normal;
            (
                Vector3::new(x * x, 2.0 * x * y, y * y),
                edge.px.min(UNFITTED_PX).powi(2),
            )
        })
        .collect();
    let mut s = Vector3::new(1.0, 0.0, 1.0);
    for _ in 0..ROUNDS {
        // Regularisation: negligible if the edges determine every direction, enough to solve if they do not.
        let (mut normal, mut right) = (Matrix3::identity() * 1e-6, Vector3::zeros());
        for (row, variance) in &equations {
            let weight = 1.0 / (variance - row.dot(&s)).abs().max(ALIKE_PX2);
            normal += weight * row * row.transpose();
            right += weight * *variance * row;
        }
        s = normal.cholesky()?.solve(&right);
    }
    let rows: Matrix3<f64> = equations.iter().map(|(row, _)| row * row.transpose()).sum();
    let told = SymmetricEigen::new(rows / equations.len().max(1) as f64);
    if told.eigenvalues.iter().filter(|value| **value < TOLD).count() > 1 {
        return None;
    }
    let least = told.eigenvalues.imin();
    let untold = told.eigenvectors.column(least).into_owned();
    let [one, other] = if told.eigenvalues[least] < TOLD {
        [1.0, -1.0].map(|sign| sign * furthest(&s, &(sign * untold)))
    } else {
        [0.0, 0.0]
    };
    let worst = [one, other].map(|t| eigenvalues(&(s + t * untold))[1]);
    Some(worst[0].max(worst[1]).max(0.0).sqrt())
}

/// Returns the distance S = `s` can move along `way` (px²) until its smallest eigenvalue is that of the sharpest photo; 0 if it is smaller already.
fn furthest(s: &Vector3<f64>, way: &Vector3<f64>) -> f64 {
    let is_possible = |t: f64| eigenvalues(&(s + t * way))[0] >= LEAST_BLUR_PX.powi(2);
    let (mut low, mut high) = (0.0, 2.0 * s.norm());
    for _ in 0..30 {
        let middle = (low + high) / 2.0;
        if is_possible(middle) {
            low = middle
        } else {
            high = middle
        }
    }
    low
}

/// Returns the eigenvalues of [[a, b], [b, c]], ascending.
fn eigenvalues(s: &Vector3<f64>) -> [f64; 2] {
    let values = Matrix2::new(s[0], s[1], s[1], s[2]).symmetric_eigenvalues();
    [values.min(), values.max()]
}

/// Long side, px, of the images to which limits in px refer; larger images may be blurred and moved more in proportion, since they are searched at
/// reduced size.
const LIMITS_FOR_PX: f64 = 1280.0;

/// Returns the scale of limits in px for an image: its long side relative to 1280 px, at least 1.
pub fn limit_scale(size_px: [u32; 2]) -> f64 {
    (f64::from(size_px[0].max(size_px[1])) / LIMITS_FOR_PX).max(1.0)
}

/// Blur (σ, px of 1280) of the steepest edges from which on an image shows no tag.
pub const HOPELESS_BLUR_PX: f64 = 3.5;

/// Estimates the blur (σ, px) across and along the image from the contrast C and the gradient g of the steepest thousandth of the pixels: C / (g
/// √2π). Coarse; for images without a whole tag. `None` for an image of one tone.
pub fn sharpest_edges_px(grey: &GrayImage) -> [Option<f64>; 2] {
    let mut steep = [[0u32; 256]; 2];
    let mut tones = [0u32; 256];
    let (width, height) = grey.dimensions();
    let raw = grey.as_raw();
    let stride = width as usize;
    for y in 1..height.saturating_sub(1) as usize {
        for x in 1..width.saturating_sub(1) as usize {
            let i = y * stride + x;
            steep[0][usize::from(raw[i + 1].abs_diff(raw[i - 1]))] += 1;
            steep[1][usize::from(raw[i + stride].abs_diff(raw[i - stride]))] += 1;
            tones[usize::from(raw[i])] += 1;
        }
    }
    let count: u32 = tones.iter().sum();
    let level = |histogram: &[u32; 256], share: f64| {
        let mut below = 0;
        (0..256).find(|v| {
            below += histogram[*v];
            f64::from(below) > share * f64::from(count)
        })
    };
    let contrast = level(&tones, 0.99)
        .zip(level(&tones, 0.01))
        .map_or(0.0, |(light, dark)| light as f64 - dark as f64);
    steep.map(|steep| {
        let gradient = level(&steep, 0.999)? as f64 / 2.0;
        (contrast > 0.0 && gradient > 0.0).then(|| contrast / (gradient * std::f64::consts::TAU.sqrt()))
    })
}
