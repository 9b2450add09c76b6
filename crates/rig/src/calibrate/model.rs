//! The ladder of camera models, from the smallest up.

use nalgebra::DMatrix;

use scaleproof_pose::camera::Camera;
use scaleproof_pose::camera::projection::PARAMETERS;

/// Every number of the largest model: fx, fy, cx, cy, then k1, k2, p1, p2, k3, k4, k5, k6 in OpenCV's order.
pub(super) const ALL: usize = PARAMETERS;

/// The camera parameters that are fitted; others are 0, and a principal point that is not fitted is the image's centre.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, serde::Serialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LensModel {
    /// One focal length.
    F,
    /// One focal length and the principal point.
    FC,
    /// One focal length, the principal point and k1.
    K1,
    /// One focal length, the principal point, k1 and k2.
    K1K2,
    /// Two focal lengths, the principal point, and k1, k2, p1, p2, k3.
    PlumbBob,
    /// Two focal lengths, the principal point, and k1, k2, p1, p2, k3, k4, k5, k6.
    Rational,
}

impl LensModel {
    /// From the smallest up; each contains those before it.
    pub const LADDER: [LensModel; 6] = [
        LensModel::F,
        LensModel::FC,
        LensModel::K1,
        LensModel::K1K2,
        LensModel::PlumbBob,
        LensModel::Rational,
    ];

    /// What people call it.
    pub fn name(self) -> &'static str {
        self.facts().0
    }

    /// How many numbers are fitted.
    pub fn parameters(self) -> usize {
        self.facts().1
    }

    /// Its name, and how many numbers are fitted.
    fn facts(self) -> (&'static str, usize) {
        match self {
            LensModel::F => ("f", 1),
            LensModel::FC => ("f, c", 3),
            LensModel::K1 => ("f, c, k1", 4),
            LensModel::K1K2 => ("f, c, k1, k2", 5),
            LensModel::PlumbBob => ("plumb_bob", 9),
            LensModel::Rational => ("rational", ALL),
        }
    }

    /// The matrix that takes the fit's parameters to the numbers of [`ALL`]; one focal length is two of them.
    pub(super) fn parameters_to_numbers(self) -> DMatrix<f64> {
        let shared = usize::from(self < LensModel::PlumbBob);
        DMatrix::from_fn(ALL, self.parameters(), |number, p| {
            f64::from(u8::from(number.saturating_sub(shared) == p))
        })
    }
}

/// The numbers of [`ALL`] as a camera for images of a size.
pub(super) fn camera((width, height): (u32, u32), all: &[f64; ALL]) -> Camera {
    Camera::pinhole(width, height, all[0], all[1], all[2], all[3]).with_distortion(&all[4..])
}

/// Where the smallest model starts: a focal length, and the image's centre (pixel (0, 0) is a pixel's centre).
pub(super) fn start((width, height): (u32, u32), focal_px: f64) -> [f64; ALL] {
    let [cx, cy] = [width, height].map(|side| (f64::from(side) - 1.0) / 2.0);
    let mut all = [0.0; ALL];
    all[..4].copy_from_slice(&[focal_px, focal_px, cx, cy]);
    all
}
