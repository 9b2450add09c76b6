//! Distortion of a lens: its model and coefficients.

use super::{brown_conrady, fisheye};

/// Distortion model of a lens, which defines the meaning of its coefficients.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DistortionModel {
    /// OpenCV's rational model (OpenCV documentation, "Camera Calibration and 3D Reconstruction").
    BrownConrady,
    /// Kannala and Brandt's model as OpenCV's `cv::fisheye` and Kalibr's `equidistant` write it, for rays up to 85° off the optical axis.
    Fisheye,
}

impl DistortionModel {
    /// Returns the coefficients' names, in OpenCV's order.
    pub fn names(self) -> &'static [&'static str] {
        match self {
            DistortionModel::BrownConrady => &["k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"],
            DistortionModel::Fisheye => &["k1", "k2", "k3", "k4"],
        }
    }
}

/// Distortion model and its coefficients in the order of [`DistortionModel::names`]; unused entries are 0.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Distortion {
    pub(super) model: DistortionModel,
    pub(super) coefficients: [f64; 8],
    /// Largest distance from the optical axis, at depth 1, up to which the distorted radius grows with the undistorted one.
    pub(super) valid_radius: f64,
}

impl Distortion {
    pub(super) fn new(model: DistortionModel, coefficients: [f64; 8]) -> Distortion {
        let valid_radius = match model {
            DistortionModel::BrownConrady => brown_conrady::valid_radius(&coefficients),
            DistortionModel::Fisheye => fisheye::valid_radius(&coefficients),
        };
        Distortion {
            model,
            coefficients,
            valid_radius,
        }
    }
}
