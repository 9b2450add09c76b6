//! The ladder of camera models, from the smallest up.

use nalgebra::DMatrix;

use scaleproof_pose::camera::DistortionModel;
use scaleproof_pose::camera::projection::{PARAMETERS, Parameters};

/// Number of parameters of the largest model: fx, fy, cx, cy, then k1, k2, p1, p2, k3, k4, k5, k6 in OpenCV's order.
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
    /// Two focal lengths, the principal point, and k1, k2, k3, k4 of Kannala and Brandt's fisheye.
    Fisheye,
    /// Two focal lengths, the principal point, and k1, k2, p1, p2, k3, k4, k5, k6.
    Rational,
}

impl LensModel {
    /// Models in the order in which they are preferred. Each contains those before it, but for the fisheye, which contains none and is contained in
    /// none: it stands behind `plumb_bob`, which more programs read, and before `rational`, which has more numbers.
    pub const LADDER: [LensModel; 7] = [
        LensModel::F,
        LensModel::FC,
        LensModel::K1,
        LensModel::K1K2,
        LensModel::PlumbBob,
        LensModel::Fisheye,
        LensModel::Rational,
    ];

    pub fn name(self) -> &'static str {
        self.facts().0
    }

    pub fn parameters(self) -> usize {
        self.facts().1
    }

    fn facts(self) -> (&'static str, usize) {
        match self {
            LensModel::F => ("f", 1),
            LensModel::FC => ("f, c", 3),
            LensModel::K1 => ("f, c, k1", 4),
            LensModel::K1K2 => ("f, c, k1, k2", 5),
            LensModel::PlumbBob => ("plumb_bob", 9),
            LensModel::Fisheye => ("fisheye", 8),
            LensModel::Rational => ("rational", ALL),
        }
    }

    /// Returns the matrix that takes the fit's parameters to the numbers of [`ALL`]; one focal length is two of them.
    pub(super) fn parameters_to_numbers(self) -> DMatrix<f64> {
        let shared = usize::from(self < LensModel::PlumbBob);
        DMatrix::from_fn(ALL, self.parameters(), |number, p| {
            f64::from(u8::from(number.saturating_sub(shared) == p))
        })
    }
}

/// Returns the start of a model: a focal length, and the image's centre (pixel (0, 0) is a pixel's centre).
pub(super) fn start(model: LensModel, (width, height): (u32, u32), focal_px: f64) -> Parameters {
    let [cx, cy] = [width, height].map(|side| (f64::from(side) - 1.0) / 2.0);
    let mut values = [0.0; ALL];
    values[..4].copy_from_slice(&[focal_px, focal_px, cx, cy]);
    let model = if model == LensModel::Fisheye {
        DistortionModel::Fisheye
    } else {
        DistortionModel::BrownConrady
    };
    Parameters { model, values }
}
