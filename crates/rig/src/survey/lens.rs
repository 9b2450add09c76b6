//! Correction of the lens by the photos, where the camera file's does not fit.
//!
//! Tags that one photo shows at its two sides are tied by the lens's distortion there, where a calibration has seen the board least. An error of the
//! lens turns each link of a chain of tags the same way, and the chain opens. Many photos of the same tags determine the lens (self-calibration:
//! Triggs et al. 2000, "Bundle Adjustment - A Modern Synthesis", section 2); it is only taken where that explains much more than noise.

use nalgebra::SMatrix;

use super::adjust::{Free, LensEquations, Loss, adjust, lens_equations};
use super::lens_numbers::{LENS, LensNumbers, changed};
use super::network::{Poses, TINY, TagNetwork};
use scaleproof_pose::camera::Camera;
use scaleproof_pose::locate::expected_px2;

/// Expected errors of a calibration, σ of each number. Autofocus moves the focal length by about so much from photo to photo; the coefficients are
/// those of a lens that moves its image by 1 % at the middle of a side.
const EXPECTED: [f64; LENS] = [0.01, 0.05, 0.2];

/// Number of σ of a corner coordinate by whose square the cost must fall for a lens to be taken; the expected σ ([`expected_px2`]) where the photos
/// are better: residuals of renders are no noise, and any further number explains some of them.
const LENS_SIGMAS: f64 = 8.0;

pub(super) struct FittedLens {
    /// The covariance of its numbers for corners of σ = 1 px.
    pub covariance: SMatrix<f64, LENS, LENS>,
    /// Derivatives of the tags, as in [`LensEquations`].
    pub by_tag: Vec<Option<SMatrix<f64, 6, LENS>>>,
}

/// Fits the lens about the given one, and adjusts the poses; `None`, and the given lens, where it is hardly better. `noise_px`: σ of a corner
/// coordinate of weight 1.
pub(super) fn fit(
    net: &mut TagNetwork,
    poses: &mut Poses,
    given: &Camera,
    loss: Loss,
    noise_px: f64,
) -> Option<FittedLens> {
    net.camera = given.clone();
    let stiffness = SMatrix::from_diagonal(&LensNumbers::from(EXPECTED).map(|sigma| (noise_px / sigma).powi(2)));
    let at = |by: &LensNumbers, start: &Poses| {
        let mut net = net.clone();
        net.camera = changed(given, by);
        let mut poses = start.clone();
        let left = adjust(&net, &mut poses, Free::All, loss, 50) + by.dot(&(stiffness * by));
        (left, net, poses)
    };
    let mut by = LensNumbers::zeros();
    let mut best = at(&by, poses);
    let as_given = best.0;
    let (information, by_tag) = loop {
        let LensEquations {
            curvature,
            gradient,
            by_tag,
        } = lens_equations(&best.1, &best.2, loss)?;
        let information = (curvature + stiffness).cholesky()?;
        let step = information.solve(&-(gradient + stiffness * by));
        let next = at(&(by + step), &best.2);
        if next.0 > best.0 - 1e-3 * noise_px * noise_px {
            break (information, by_tag);
        }
        (by, best) = (by + step, next);
    };
    if as_given - best.0 < LENS_SIGMAS.powi(2) * expected_px2(&TINY).max(noise_px * noise_px) {
        return None;
    }
    (*net, *poses) = (best.1, best.2);
    Some(FittedLens {
        covariance: information.inverse(),
        by_tag,
    })
}
