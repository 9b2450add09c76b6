//! Calibrated camera with its uncertainty and its photos.

use super::board_photo::UnusedPhoto;
use super::error::CalibrationCaution;
use super::ladder::CandidateModel;
use super::model;
use super::uncertainty::UncertaintyMap;
use scaleproof_pose::board::Definition;
use scaleproof_pose::camera::Camera;

/// Corners, residuals and pose of one photo of the camera.
#[derive(Debug, Clone)]
pub struct PhotoResult {
    pub file: String,
    /// As [`turned_deg`](super::board_photo::BoardPhoto::turned_deg).
    pub turned_deg: u32,
    /// Corners in the photo, px, and seen minus projected, px.
    pub corners_px: Vec<[f64; 2]>,
    pub residuals_px: Vec<[f64; 2]>,
    pub rms_px: f64,
    /// Angle between the board's normal, or that of a scene's table, and the optical axis.
    pub tilt_deg: f64,
    pub distance_mm: f64,
    pub edge_width_px: Option<f64>,
}

/// A calibrated camera and its uncertainty.
#[derive(Debug, Clone)]
pub struct Calibration {
    /// The board; `None` where it was the tags of a scene.
    pub board: Option<Definition>,
    pub camera: Camera,
    /// Every model that could be fitted, from the smallest up.
    pub models: Vec<CandidateModel>,
    /// Index of the camera's model in `models`.
    pub chosen: usize,
    /// Standard deviations of fx, fy, cx, cy (px), then the camera's coefficients; 0 for what the model does not fit. By the scatter of the corners, or by
    /// leaving photos out where that is larger.
    pub sigmas: [f64; model::ALL],
    /// Root mean square residual over all corners, px.
    pub rms_px: f64,
    pub photos: Vec<PhotoResult>,
    pub left_out: Vec<UnusedPhoto>,
    /// Corners left out of photos that stay.
    pub lost_corners: usize,
    /// Corners seen in each cell of a 10 × 10 grid over the image, row by row.
    pub coverage: Vec<u32>,
    pub map: UncertaintyMap,
    /// Ratio of the focal length's standard deviation, from leaving photos out, to that by the scatter of the corners alone.
    pub focal_raised: f64,
    pub cautions: Vec<CalibrationCaution>,
}

impl Calibration {
    pub fn chosen_model(&self) -> &CandidateModel {
        &self.models[self.chosen]
    }
}

/// Cells of the coverage grid along each side.
pub const COVERAGE: usize = 10;
