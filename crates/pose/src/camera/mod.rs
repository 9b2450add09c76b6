//! The camera: pinhole and Brown–Conrady distortion, in OpenCV's conventions.

mod fault;
mod fit;
mod format;
mod guess;
mod kalibr;
mod matrix_yaml;
mod mrcal;
pub mod projection;
pub mod yaml;

use scaleproof_core::files;

pub use fault::CameraFault;
pub use fit::{FittedCamera, SizeError};
pub use format::CameraFormat;
pub use guess::{Guess, GuessError};

/// Why a camera file was refused.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CameraError {
    #[error(transparent)]
    File(#[from] files::FileError),
    #[error("the camera cannot be written as {format}: {fault}")]
    NotInFormat { format: &'static str, fault: CameraFault },
}

/// Intrinsics of one camera at one image size. Pixel (0, 0) is the *centre* of the top-left pixel.
#[derive(Debug, Clone, PartialEq)]
pub struct Camera {
    /// Width of the image, px.
    pub width: u32,
    /// Height of the image, px.
    pub height: u32,
    /// Focal length across the image, px.
    pub fx: f64,
    /// Focal length down the image, px.
    pub fy: f64,
    /// Principal point, px from the centre of the left-most pixels.
    pub cx: f64,
    /// Principal point, px from the centre of the top-most pixels.
    pub cy: f64,
    distortion: Distortion,
    /// Present when the focal length was guessed instead of measured.
    pub guess: Option<Guess>,
    /// One standard deviation of fx, fy, cx, cy in pixels, where a calibration knows it.
    pub sigma_px: Option<[f64; 4]>,
}

/// Brown–Conrady coefficients in OpenCV's order: k1, k2, p1, p2, k3, k4, k5, k6; those not given are 0.
///
/// Source of the formula: OpenCV documentation, "Camera Calibration and 3D Reconstruction".
#[derive(Debug, Clone, PartialEq)]
struct Distortion {
    coefficients: [f64; 8],
    /// Distance from the optical axis, at depth 1, up to which a longer radius still lands further out.
    valid_radius: f64,
}

impl Camera {
    /// A camera without distortion. Focal length and principal point in pixels.
    pub fn pinhole(width: u32, height: u32, fx: f64, fy: f64, cx: f64, cy: f64) -> Camera {
        Camera {
            width,
            height,
            fx,
            fy,
            cx,
            cy,
            distortion: Distortion::new([0.0; 8]),
            guess: None,
            sigma_px: None,
        }
    }

    /// The camera with these distortion coefficients, in OpenCV's order; at most eight, missing ones are 0.
    pub fn with_distortion(self, coefficients: &[f64]) -> Camera {
        let mut all = [0.0; 8];
        all.iter_mut().zip(coefficients).for_each(|(to, from)| *to = *from);
        Camera {
            distortion: Distortion::new(all),
            ..self
        }
    }

    /// k1, k2, p1, p2, k3, k4, k5, k6.
    pub fn distortion(&self) -> &[f64; 8] {
        &self.distortion.coefficients
    }

    /// The first coefficients, in the smallest of some numbers (ascending, the last one 8) that leaves out none but zeros.
    fn needed_coefficients(&self, counts: &[usize]) -> &[f64] {
        let all = self.distortion().as_slice();
        let enough = counts.iter().find(|n| all[**n..].iter().all(|v| *v == 0.0));
        &all[..enough.copied().unwrap_or(all.len())]
    }

    /// Refuses numbers that no camera has: a file of something else, or one whose decimal commas became list commas.
    fn check(&self) -> Result<(), CameraFault> {
        let &Camera {
            width, height, fx, fy, ..
        } = self;
        if [width, height].iter().any(|side| !(1..=100_000).contains(side)) {
            return Err(CameraFault::Size { width, height });
        }
        let (cx, cy, width, height) = (self.cx, self.cy, f64::from(width), f64::from(height));
        let larger = width.max(height);
        // 169 to 0.6 degrees across.
        let (least, most) = (0.05 * larger, 100.0 * larger);
        if [fx, fy].iter().any(|f| !(least..=most).contains(f)) {
            return Err(CameraFault::Focal { fx, fy, least, most });
        }
        let is_inside = |c: f64, side: f64| (-side..=2.0 * side).contains(&c);
        if !is_inside(cx, width) || !is_inside(cy, height) {
            return Err(CameraFault::PrincipalPoint { cx, cy });
        }
        // Long lenses have small radii and large coefficients; this only keeps numbers that overflow away.
        let odd = self.distortion().iter().find(|k| !k.is_finite() || k.abs() > 1e9);
        odd.map_or(Ok(()), |k| Err(CameraFault::Coefficient(*k)))
    }

    /// The angle in degrees that one pixel covers at the centre of the image.
    pub fn deg_per_px(&self) -> f64 {
        (2.0 / (self.fx + self.fy)).atan().to_degrees()
    }
}

impl Distortion {
    fn new(coefficients: [f64; 8]) -> Distortion {
        Distortion {
            coefficients,
            valid_radius: projection::valid_radius(&coefficients),
        }
    }
}
