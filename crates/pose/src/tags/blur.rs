//! How blurred a photo is in the direction of its most blur: from straight edges of known direction, or coarsely from all its edges.

use image::GrayImage;
use nalgebra::{Matrix2, Matrix3, SymmetricEigen, Vector3};

/// The blur that lens and pixel leave in the sharpest photo, px (standard deviation): 0.44 to 0.53 in the stored ones.
const LEAST_BLUR_PX: f64 = 0.4;

/// The normal matrix of the edges' directions, divided by their number, has this smallest eigenvalue at least where every direction is told;
/// it is ¼ for directions spread evenly, and 0 for those of one square.
const TOLD: f64 = 0.03;

/// An edge that no fit found counts as this blurred, px: the half width of the widest band that is looked at.
const UNFITTED_PX: f64 = 6.0;

/// Rounds of reweighting, and the difference (px²) below which all weigh alike.
const ROUNDS: usize = 15;
const ALIKE_PX2: f64 = 0.02;

/// The blur across one side of a tag.
#[derive(Debug, Clone, Copy)]
pub struct EdgeBlur {
    /// The tag's place among those that were given.
    pub tag: usize,
    /// From which of its corners the side goes to the next.
    pub side: usize,
    pub normal: [f64; 2],
    /// Standard deviation across the edge, px; infinity where the edge is too blurred to be fitted.
    pub px: f64,
}

/// The standard deviation of the blur in its worst direction, px; infinity when most edges are too blurred to be fitted, `None` without edges of
/// two directions.
///
/// A blur of covariance S spreads an edge of normal n by the variance nᵀSn (convolution adds variances), so that S follows from edges of three
/// directions, and the worst direction is its largest eigenvector. The sum of absolute differences is minimised (iteratively reweighted least
/// squares, Schlossmacher 1973), since some edges lie in shadow or at another depth. The sides of squares that all lie one way do not tell motion
/// along the diagonal from a blur of all directions: S is then the worst that agrees with them.
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
        // As small as not to matter where the edges tell every direction, enough to solve where they do not.
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

/// How far S = `s` may go along `way` (px²) until its least eigenvalue is that of the sharpest photo; 0 where it is less already.
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

/// The eigenvalues of [[a, b], [b, c]], ascending.
fn eigenvalues(s: &Vector3<f64>) -> [f64; 2] {
    let values = Matrix2::new(s[0], s[1], s[1], s[2]).symmetric_eigenvalues();
    [values.min(), values.max()]
}

/// The long side that limits in px are for; larger images may be blurred and moved more in proportion, since they are seen reduced.
const LIMITS_FOR_PX: f64 = 1280.0;

/// How many times longer an image is than the one that limits in px are for; small ones have the same limits.
pub fn limit_scale(size_px: [u32; 2]) -> f64 {
    (f64::from(size_px[0].max(size_px[1])) / LIMITS_FOR_PX).max(1.0)
}

/// An image whose steepest edges are as wide as this blur (σ, px of 1280) shows no tag.
pub const HOPELESS_BLUR_PX: f64 = 3.5;

/// The blur (σ, px) across and along the image that would make the steepest edges of an image from its own contrast: C / (g √2π) for the gradient g
/// of a thousandth of the pixels. Coarse; for images without a whole tag. `None` for an image of one tone.
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
