//! Intrinsics of a camera.

use super::distortion::{Distortion, DistortionModel};
use scaleproof_core::message::{Message, bail, message};

/// Intrinsics of one camera at one image size. Pixel (0, 0) is the *centre* of the top-left pixel.
#[derive(Debug, Clone, PartialEq)]
pub struct Camera {
    /// Width of the image, px.
    pub width: u32,
    /// Height of the image, px.
    pub height: u32,
    /// Horizontal focal length, px.
    pub fx: f64,
    /// Vertical focal length, px.
    pub fy: f64,
    /// Principal point, px from the centre of the left-most pixels.
    pub cx: f64,
    /// Principal point, px from the centre of the top-most pixels.
    pub cy: f64,
    pub(super) distortion: Distortion,
    /// Uncertainty of the focal length, if it was guessed instead of measured.
    pub guess: Option<Guess>,
    /// Standard deviations of fx, fy, cx, cy in pixels, if the calibration has them.
    pub sigma_px: Option<[f64; 4]>,
}

/// Uncertainty of a guessed focal length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Guess {
    /// Bound of the error: the true focal length lies within ± this many percent.
    pub focal_percent: f64,
}

impl Camera {
    /// Returns a camera without distortion. Focal length and principal point in pixels.
    pub fn pinhole(width: u32, height: u32, fx: f64, fy: f64, cx: f64, cy: f64) -> Camera {
        Camera {
            width,
            height,
            fx,
            fy,
            cx,
            cy,
            distortion: Distortion::new(DistortionModel::BrownConrady, [0.0; 8]),
            guess: None,
            sigma_px: None,
        }
    }

    /// Returns the camera with other coefficients of its distortion model, in OpenCV's order; missing ones are 0, surplus ones are ignored. A fisheye
    /// stays a fisheye: without coefficients it is the ideal equidistant lens.
    pub fn with_distortion(self, coefficients: &[f64]) -> Camera {
        let model = self.distortion.model;
        self.with_model(model, coefficients)
    }

    /// Returns the camera as a fisheye with the coefficients k1, k2, k3, k4 ([`DistortionModel::Fisheye`]).
    pub fn with_fisheye(self, coefficients: [f64; 4]) -> Camera {
        self.with_model(DistortionModel::Fisheye, &coefficients)
    }

    fn with_model(self, model: DistortionModel, coefficients: &[f64]) -> Camera {
        let mut all = [0.0; 8];
        let to = all.iter_mut().take(model.names().len());
        to.zip(coefficients).for_each(|(to, from)| *to = *from);
        Camera {
            distortion: Distortion::new(model, all),
            ..self
        }
    }

    /// Returns the model that the coefficients of [`Camera::distortion`] belong to.
    pub fn distortion_model(&self) -> DistortionModel {
        self.distortion.model
    }

    /// Returns the coefficients in the order of [`DistortionModel::names`]: eight, or four of a fisheye.
    pub fn distortion(&self) -> &[f64] {
        &self.distortion.coefficients[..self.distortion.model.names().len()]
    }

    /// Returns true for [`DistortionModel::Fisheye`].
    pub fn is_fisheye(&self) -> bool {
        self.distortion.model == DistortionModel::Fisheye
    }

    /// Returns the leading coefficients, as many as the smallest of `counts` (ascending) that drops only zeros.
    pub(super) fn needed_coefficients(&self, counts: &[usize]) -> &[f64] {
        let all = self.distortion();
        let enough = counts.iter().find(|n| all.iter().skip(**n).all(|v| *v == 0.0));
        &all[..enough.map_or(all.len(), |n| all.len().min(*n))]
    }

    /// Returns an error for implausible numbers: a file of something else, or one whose decimal commas became list commas.
    pub(super) fn check(&self) -> Result<(), Message> {
        let &Camera {
            width, height, fx, fy, ..
        } = self;
        if [width, height].iter().any(|side| !(1..=100_000).contains(side)) {
            bail!("the image size {width}×{height} must lie between 1 and 100000 pixels a side");
        }
        let (cx, cy, width, height) = (self.cx, self.cy, f64::from(width), f64::from(height));
        let larger = width.max(height);
        // Focal lengths of a field of view of 169 to 0.6 degrees.
        let (least, most) = (0.05 * larger, 100.0 * larger);
        if [fx, fy].iter().any(|f| !(least..=most).contains(f)) {
            bail!("the focal lengths fx {fx} and fy {fy} must lie between {least} and {most} px for this image size");
        }
        let is_inside = |c: f64, side: f64| (-side..=2.0 * side).contains(&c);
        if !is_inside(cx, width) || !is_inside(cy, height) {
            bail!("the principal point ({cx}, {cy}) lies far outside the image");
        }
        // Long lenses have small radii and large coefficients; this only keeps numbers that overflow away.
        let odd = self.distortion().iter().find(|k| !k.is_finite() || k.abs() > 1e9);
        odd.map_or(Ok(()), |k| {
            Err(message!(
                "the distortion coefficient {} is no finite number below 1e9",
                *k
            ))
        })
    }

    /// Returns the horizontal and vertical field of view in degrees, without distortion: as a pinhole, or as the ideal equidistant fisheye.
    pub fn field_of_view_deg(&self) -> [f64; 2] {
        [(self.width, self.fx), (self.height, self.fy)].map(|(side, focal_px)| {
            let half = f64::from(side) / 2.0 / focal_px;
            let angle = if self.is_fisheye() { half } else { half.atan() };
            2.0 * angle.to_degrees()
        })
    }

    /// Returns the angle in degrees that one pixel covers at the centre of the image.
    pub fn deg_per_px(&self) -> f64 {
        (2.0 / (self.fx + self.fy)).atan().to_degrees()
    }
}
