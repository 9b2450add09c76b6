//! The interface of a camera's driver.

use std::time::Duration;

use super::error::LiveCameraError;
use super::pixels::RawImage;
use super::settings::CameraSettings;

/// Exposure, focus and white balance find their values within this time; they are then held, and frames are given from then on.
const SETTLING: Duration = Duration::from_millis(1500);

/// Interface of a camera's driver. It stays on the thread that opened it.
pub trait Device {
    /// Waits for the next image.
    ///
    /// # Errors
    /// Reason why there is none. After [`LiveCameraError::Waiting`], which the photographer is shown, it is tried again without end; ten others in a row end it.
    fn image(&mut self) -> Result<RawImage, LiveCameraError>;

    /// Holds exposure, focus and white balance where they are now, as far as the camera lets one.
    fn lock(&mut self) -> CameraSettings;

    /// Returns the time after which exposure, focus and white balance have found their values; no image is given before.
    fn settling(&self) -> Duration {
        SETTLING
    }
}
