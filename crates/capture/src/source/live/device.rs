//! The interface of a camera's driver.

use std::time::Duration;

use super::error::LiveCameraError;
use super::pixels::RawImage;
use super::settings::CameraSettings;

/// Exposure, focus and white balance find their values within this time; they are then held, and frames are given from then on.
const SETTLING: Duration = Duration::from_millis(1500);

/// What a camera must be able to do. It stays on the thread that opened it.
pub trait Device {
    /// The next image, waited for.
    ///
    /// # Errors
    /// Why there is none. [`LiveCameraError::Waiting`] is told to the photographer and asked again, without end; of any other, ten in a row end it.
    fn image(&mut self) -> Result<RawImage, LiveCameraError>;

    /// Holds exposure, focus and white balance where they are now, as far as the camera lets one.
    fn lock(&mut self) -> CameraSettings;

    /// The time after which exposure, focus and white balance have found their values; no image is given before.
    fn settling(&self) -> Duration {
        SETTLING
    }
}
