//! The system's cameras, by `nokhwa`.

use std::cmp::Reverse;
use std::sync::mpsc;
use std::time::Duration;

use nokhwa::NokhwaError;
use nokhwa::utils::{
    ApiBackend, CameraFormat, CameraIndex, ControlValueSetter, FrameFormat, KnownCameraControl, RequestedFormat,
    RequestedFormatType,
};

use super::device::Device;
use super::error::LiveCameraError;
use super::pixels::{PixelFormat, RawImage};
use super::settings::{CameraSettings, Setting};
use scaleproof_pose::camera::Camera;

/// A camera that the system knows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ListedCamera {
    /// Number in `camera:N`.
    pub number: u32,
    pub name: String,
    pub description: String,
}

/// The pixel formats that are read; the raw ones before the lossy one.
const FORMATS: [(FrameFormat, PixelFormat); 6] = [
    (FrameFormat::NV12, PixelFormat::Nv12),
    (FrameFormat::YUYV, PixelFormat::Yuyv),
    (FrameFormat::RAWRGB, PixelFormat::Rgb),
    (FrameFormat::RAWBGR, PixelFormat::Bgr),
    (FrameFormat::GRAY, PixelFormat::Grey),
    (FrameFormat::MJPEG, PixelFormat::Mjpeg),
];

/// Least number of images a second at which advice is timely.
const ENOUGH_FPS: u32 = 15;

/// Time in which a person must allow the use of the camera, where the system asks.
const PERMISSION: Duration = Duration::from_secs(60);

/// Lists the cameras of this machine, by number. Some systems list a camera several times; not every entry gives images.
///
/// # Errors
/// A system whose cameras cannot be listed.
pub fn list_cameras() -> Result<Vec<ListedCamera>, LiveCameraError> {
    allowed()?;
    let found = nokhwa::query(ApiBackend::Auto).map_err(failed)?;
    let listed = found.iter().filter_map(|info| {
        Some(ListedCamera {
            number: info.index().as_index().ok()?,
            name: info.human_name(),
            description: info.description().to_owned(),
        })
    });
    let mut cameras: Vec<ListedCamera> = listed.collect();
    cameras.sort_by_key(|camera| camera.number);
    Ok(cameras)
}

/// Asks for the use of cameras where the system wants that (macOS).
fn allowed() -> Result<(), LiveCameraError> {
    let (answer, answered) = mpsc::channel();
    nokhwa::nokhwa_initialize(move |is_allowed| {
        // Nobody waits for a late answer.
        let _ = answer.send(is_allowed);
    });
    match answered.recv_timeout(PERMISSION) {
        Ok(true) => Ok(()),
        _ => Err(LiveCameraError::Failed(
            "the system does not allow the use of cameras".into(),
        )),
    }
}

/// Opens a camera and starts it, at an image size that the camera file fits.
pub(super) fn open(number: u32, camera: &Camera) -> Result<Box<dyn Device>, LiveCameraError> {
    allowed()?;
    let formats = FORMATS.map(|(format, _)| format);
    let any = RequestedFormat::with_formats(RequestedFormatType::None, &formats);
    let mut opened = nokhwa::Camera::new(CameraIndex::Index(number), any).map_err(failed)?;
    let offered = opened.compatible_camera_formats().map_err(failed)?;
    let chosen = choose_format(&offered, camera)?;
    if opened.camera_format() != chosen {
        let exactly = RequestedFormat::with_formats(RequestedFormatType::Exact(chosen), &formats);
        opened.set_camera_requset(exactly).map_err(failed)?;
    }
    opened.open_stream().map_err(failed)?;
    Ok(Box::new(NokhwaCamera(opened)))
}

fn failed(e: NokhwaError) -> LiveCameraError {
    LiveCameraError::Failed(e.to_string())
}

/// Chooses the size nearest to the calibrated one among those of its shape; of one size, enough images a second first, then raw pixels.
///
/// # Errors
/// None has the shape of the camera file's images.
pub fn choose_format(offered: &[CameraFormat], camera: &Camera) -> Result<CameraFormat, LiveCameraError> {
    let fits = |format: &&CameraFormat| camera.scaled_to(format.width(), format.height()).is_ok();
    let rank = |format: &CameraFormat| FORMATS.iter().position(|(known, _)| *known == format.format());
    let order = |format: &&CameraFormat| {
        (
            format.width().abs_diff(camera.width),
            format.frame_rate() < ENOUGH_FPS,
            rank(format),
            Reverse(format.frame_rate()),
        )
    };
    let readable = offered.iter().filter(|format| rank(format).is_some());
    let none = || {
        let (width, height) = (camera.width, camera.height);
        LiveCameraError::Failed(format!(
            "it has no image of the shape of the camera file's, {width} × {height}: calibrate it at a size it has"
        ))
    };
    readable.filter(fits).min_by_key(order).copied().ok_or_else(none)
}

struct NokhwaCamera(nokhwa::Camera);

impl Device for NokhwaCamera {
    fn image(&mut self) -> Result<RawImage, LiveCameraError> {
        let format = self.0.camera_format();
        let packed = FORMATS.iter().find(|(known, _)| *known == format.format());
        let (_, packed) = packed.ok_or_else(|| LiveCameraError::Failed("its pixel format is not known".into()))?;
        Ok(RawImage {
            format: *packed,
            width: format.width(),
            height: format.height(),
            bytes: self.0.frame_raw().map_err(failed)?.into_owned(),
        })
    }

    fn lock(&mut self) -> CameraSettings {
        let format = self.0.camera_format();
        let (pixels, width, height) = (format.format(), format.width(), format.height());
        let [exposure, focus, white_balance] = lock_controls().map(|how| self.held(how));
        CameraSettings {
            device: self.0.info().human_name(),
            format: format!("{pixels} {width} × {height}, {} frames a second", format.frame_rate()),
            exposure,
            focus,
            white_balance,
        }
    }
}

/// Controls of a setting: the one that makes it automatic, its value for "by hand", and the one of the setting itself.
type LockControl = (KnownCameraControl, ControlValueSetter, KnownCameraControl);

/// Returns the controls of exposure, focus and white balance, by the ids of Video4Linux (`linux/v4l2-controls.h`): V4L2_CID_EXPOSURE_AUTO (1: manual),
/// V4L2_CID_EXPOSURE_ABSOLUTE; V4L2_CID_FOCUS_AUTO, V4L2_CID_FOCUS_ABSOLUTE; V4L2_CID_AUTO_WHITE_BALANCE,
/// V4L2_CID_WHITE_BALANCE_TEMPERATURE.
#[cfg(target_os = "linux")]
fn lock_controls() -> [LockControl; 3] {
    use ControlValueSetter::{Boolean, Integer};
    use KnownCameraControl::{Other, WhiteBalance};
    [
        (Other(0x009a_0901), Integer(1), Other(0x009a_0902)),
        (Other(0x009a_090c), Boolean(false), Other(0x009a_090a)),
        (Other(0x0098_090c), Boolean(false), WhiteBalance),
    ]
}

/// Returns one control for both, as elsewhere: mode 0 of AVFoundation is "locked".
#[cfg(not(target_os = "linux"))]
fn lock_controls() -> [LockControl; 3] {
    use KnownCameraControl::{Exposure, Focus, WhiteBalance};
    [Exposure, Focus, WhiteBalance].map(|control| (control, ControlValueSetter::EnumValue(0), control))
}

impl NokhwaCamera {
    fn held(&mut self, (automatic, by_hand, control): LockControl) -> Setting {
        // Read first: some drivers fall back to a stored value when they are no longer automatic.
        let value = self.value(control);
        let is_locked = self.0.set_camera_control(automatic, by_hand).is_ok();
        if let (true, Some(value)) = (is_locked, value) {
            // Where it cannot be set, the driver keeps the value it had: what it says now is what is written down.
            let _ = self.0.set_camera_control(control, ControlValueSetter::Integer(value));
        }
        let value = self.value(control);
        Setting { is_locked, value }
    }

    fn value(&self, control: KnownCameraControl) -> Option<i64> {
        match self.0.camera_control(control).ok()?.value() {
            ControlValueSetter::Integer(value) | ControlValueSetter::EnumValue(value) => Some(value),
            _ => None,
        }
    }
}
