//! Adaptation of a camera to a photo that was scaled or turned.

use super::distortion::{Distortion, DistortionModel};
use super::model::Camera;

/// Camera that fits one photo, and how it was derived from the camera file.
#[derive(Debug, Clone, PartialEq)]
pub struct FittedCamera {
    /// The camera at the size and orientation of the photo.
    pub camera: Camera,
    /// Width of the photo by width of the camera file's image, before turning; 1 when nothing was scaled.
    pub scale: f64,
    /// Clockwise, as EXIF says the photo was turned; 0 when the camera file is for the upright photo.
    pub turned_deg: u32,
}

/// Reason why a camera file does not fit a photo.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SizeError {
    #[error(
        "the photo is {photo} but the camera file is for {camera}, another aspect ratio, so the photo was cropped by an unknown amount: use the original photo, or calibrate at this size"
    )]
    Cropped { photo: String, camera: String },
    #[error(
        "the photo is {photo} but the camera file is for {camera}, and no EXIF data says which way the photo was turned: use the original photo, or calibrate with photos held this way"
    )]
    Turned { photo: String, camera: String },
}

impl Camera {
    /// Returns the camera for an upright photo of a size in pixels that EXIF turned clockwise by `turned_deg` (0, 90, 180 or 270).
    ///
    /// The camera file may be for the image as it lies on the sensor, which is then turned with the photo, or for upright photos held the same way.
    /// Returns an error for a photo that was cropped, or turned in an unknown way.
    pub fn for_photo(&self, width: u32, height: u32, turned_deg: u32) -> Result<FittedCamera, SizeError> {
        let lies_across = turned_deg % 180 == 90;
        let (sensor_width, sensor_height) = if lies_across { (height, width) } else { (width, height) };
        if let Some(scaled) = self.scaled(sensor_width, sensor_height) {
            return Ok(FittedCamera {
                camera: (0..turned_deg / 90).fold(scaled, |camera, _| camera.turned_clockwise()),
                scale: f64::from(sensor_width) / f64::from(self.width),
                turned_deg,
            });
        }
        let upright = self.scaled(width, height).filter(|_| lies_across);
        Ok(FittedCamera {
            camera: upright.ok_or_else(|| self.mismatch(width, height))?,
            scale: f64::from(width) / f64::from(self.width),
            turned_deg: 0,
        })
    }

    /// Maps a photo's pixel to the image that this camera file is for; `fitted` is this camera as fitted to the photo.
    pub fn unfitted_px(&self, fitted: &FittedCamera, [mut x, mut y]: [f64; 2]) -> [f64; 2] {
        let (mut width, mut height) = (f64::from(fitted.camera.width), f64::from(fitted.camera.height));
        for _ in 0..fitted.turned_deg / 90 {
            (x, y) = (y, width - 1.0 - x);
            (width, height) = (height, width);
        }
        let unscaled = |c: f64, from: f64, to: u32| (c + 0.5) * f64::from(to) / from - 0.5;
        [unscaled(x, width, self.width), unscaled(y, height, self.height)]
    }

    /// Returns the camera for the same image at another size in pixels; an error if the aspect ratio differs by more than rounding.
    ///
    /// Pixel (0, 0) is the centre of the top-left pixel, so a principal point moves as (c + ½)·s − ½.
    pub fn scaled_to(&self, width: u32, height: u32) -> Result<Camera, SizeError> {
        self.scaled(width, height).ok_or_else(|| self.mismatch(width, height))
    }

    fn scaled(&self, width: u32, height: u32) -> Option<Camera> {
        let [sx, sy] = self.scale_to(width, height)?;
        let scaled = |[fx, fy, cx, cy]: [f64; 4]| [fx * sx, fy * sy, cx * sx, cy * sy];
        Some(Camera {
            width,
            height,
            fx: self.fx * sx,
            fy: self.fy * sy,
            cx: (self.cx + 0.5) * sx - 0.5,
            cy: (self.cy + 0.5) * sy - 0.5,
            sigma_px: self.sigma_px.map(scaled),
            ..self.clone()
        })
    }

    /// Returns the scale factors of width and height, if a single factor gives both sides within a pixel.
    fn scale_to(&self, width: u32, height: u32) -> Option<[f64; 2]> {
        let [w, h, own_w, own_h] = [width, height, self.width, self.height].map(f64::from);
        let least = ((w - 1.0) / own_w).max((h - 1.0) / own_h);
        let most = ((w + 1.0) / own_w).min((h + 1.0) / own_h);
        (width > 0 && height > 0 && least < most).then(|| [w / own_w, h / own_h])
    }

    fn mismatch(&self, width: u32, height: u32) -> SizeError {
        let (photo, camera) = (format!("{width}×{height}"), format!("{}×{}", self.width, self.height));
        match self.scale_to(height, width) {
            Some(_) => SizeError::Turned { photo, camera },
            None => SizeError::Cropped { photo, camera },
        }
    }

    /// Returns the camera of the image turned clockwise by 90°: x' = −y, y' = x on the sensor.
    fn turned_clockwise(self) -> Camera {
        let [k1, k2, p1, p2, k3, k4, k5, k6] = self.distortion.coefficients;
        Camera {
            width: self.height,
            height: self.width,
            fx: self.fy,
            fy: self.fx,
            cx: f64::from(self.height) - 1.0 - self.cy,
            cy: self.cx,
            // With x' and y' put into the tangential terms, p1 and p2 change places, one of them with its sign.
            distortion: match self.distortion.model {
                DistortionModel::BrownConrady => {
                    Distortion::new(self.distortion.model, [k1, k2, p2, -p1, k3, k4, k5, k6])
                }
                DistortionModel::Fisheye => self.distortion,
            },
            sigma_px: self.sigma_px.map(|[fx, fy, cx, cy]| [fy, fx, cy, cx]),
            ..self
        }
    }
}

impl FittedCamera {
    /// Returns the cautions that apply to a pose made with this camera, as sentences.
    pub fn cautions(&self) -> Vec<String> {
        let guessed = self.camera.guess.map(|g| g.caution());
        self.scaled_caution().into_iter().chain(guessed).collect()
    }

    /// Returns a caution if the camera was scaled: scaling assumes that the photo was resized as a whole.
    pub fn scaled_caution(&self) -> Option<String> {
        let scale = self.scale;
        (scale != 1.0).then(|| {
            format!(
                "the camera file is for another size and was scaled by {scale:.3}: right for a photo made smaller or larger as a whole, wrong for one cut \
                 out of a larger image"
            )
        })
    }
}
