//! The system's cameras, by `nokhwa`.

use std::cmp::Reverse;
use std::sync::mpsc;
use std::time::Duration;

use nokhwa::NokhwaError;
use nokhwa::utils::{
    ApiBackend, CameraFormat, CameraIndex, ControlValueSetter, FrameFormat, KnownCameraControl, RequestedFormat,
    RequestedFormatType,
};

use super::{CameraSettings, Device, LiveCameraError, PixelFormat, RawImage, Setting};
use scaleproof_pose::camera::Camera;

/// A camera that the system knows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ListedCamera {
    /// What `camera:N` calls it.
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

/// Below this many images a second, advice comes late.
const ENOUGH_FPS: u32 = 15;

/// How long a person may take to allow the use of the camera, where the system asks.
const PERMISSION: Duration = Duration::from_secs(60);

/// The cameras of this machine, by number. Some systems list a camera several times; not every entry gives images.
///
/// # Errors
/// A system whose cameras cannot be listed.
pub fn list_cameras() -> Result<Vec<ListedCamera>, LiveCameraError> {
    allowed()?;
    let found = nokhwa::query(ApiBackend::Auto).map_err(failed)?;
    let mut cameras: Vec<ListedCamera> = found
        .iter()
        .filter_map(|info| {
            Some(ListedCamera {
                number: info.index().as_index().ok()?,
                name: info.human_name(),
                description: info.description().to_owned(),
            })
        })
        .collect();
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
        _ => Err(LiveCameraError::NotAllowed),
    }
}

/// Opens a camera and starts it, at an image size that the camera file fits.
pub(super) fn open(number: u32, camera: &Camera) -> Result<Box<dyn Device>, LiveCameraError> {
    allowed()?;
    let formats = FORMATS.map(|(format, _)| format);
    let any = RequestedFormat::with_formats(RequestedFormatType::None, &formats);
    let mut opened = nokhwa::Camera::new(CameraIndex::Index(number), any).map_err(failed)?;
    let offered = opened.compatible_camera_formats().map_err(failed)?;
    let chosen = chosen(&offered, camera)?;
    if opened.camera_format() != chosen {
        let exactly = RequestedFormat::with_formats(RequestedFormatType::Exact(chosen), &formats);
        opened.set_camera_requset(exactly).map_err(failed)?;
    }
    opened.open_stream().map_err(failed)?;
    Ok(Box::new(NokhwaCamera(opened)))
}

fn failed(e: NokhwaError) -> LiveCameraError {
    LiveCameraError::Driver(e.to_string())
}

/// The size nearest to the calibrated one among those of its shape; of one size, enough images a second first, then raw pixels.
fn chosen(offered: &[CameraFormat], camera: &Camera) -> Result<CameraFormat, LiveCameraError> {
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
    let none = LiveCameraError::NoFittingSize {
        width: camera.width,
        height: camera.height,
    };
    readable.filter(fits).min_by_key(order).copied().ok_or(none)
}

struct NokhwaCamera(nokhwa::Camera);

impl Device for NokhwaCamera {
    fn image(&mut self) -> Result<RawImage, LiveCameraError> {
        let format = self.0.camera_format();
        let packed = FORMATS.iter().find(|(known, _)| *known == format.format());
        let (_, packed) = packed.ok_or(LiveCameraError::UnknownPixelFormat)?;
        Ok(RawImage {
            format: *packed,
            width: format.width(),
            height: format.height(),
            bytes: self.0.frame_raw().map_err(failed)?.into_owned(),
        })
    }

    fn lock(&mut self) -> CameraSettings {
        let format = self.0.camera_format();
        CameraSettings {
            device: self.0.info().human_name(),
            format: format!(
                "{} {} × {}, {} frames a second",
                format.format(),
                format.width(),
                format.height(),
                format.frame_rate()
            ),
            exposure: self.held(EXPOSURE),
            focus: self.held(FOCUS),
            white_balance: self.held(WHITE_BALANCE),
        }
    }
}

/// How a setting is held: the control that decides whether it is automatic, its value for "by hand", and the control of the setting itself.
struct LockControl {
    automatic: KnownCameraControl,
    by_hand: ControlValueSetter,
    value: KnownCameraControl,
}

/// Controls of Video4Linux by their ids (`linux/v4l2-controls.h`): V4L2_CID_EXPOSURE_AUTO (1: manual), V4L2_CID_EXPOSURE_ABSOLUTE,
/// V4L2_CID_FOCUS_AUTO, V4L2_CID_FOCUS_ABSOLUTE, V4L2_CID_AUTO_WHITE_BALANCE, V4L2_CID_WHITE_BALANCE_TEMPERATURE.
#[cfg(target_os = "linux")]
const EXPOSURE: LockControl = LockControl {
    automatic: KnownCameraControl::Other(0x009a_0901),
    by_hand: ControlValueSetter::Integer(1),
    value: KnownCameraControl::Other(0x009a_0902),
};
#[cfg(target_os = "linux")]
const FOCUS: LockControl = LockControl {
    automatic: KnownCameraControl::Other(0x009a_090c),
    by_hand: ControlValueSetter::Boolean(false),
    value: KnownCameraControl::Other(0x009a_090a),
};
#[cfg(target_os = "linux")]
const WHITE_BALANCE: LockControl = LockControl {
    automatic: KnownCameraControl::Other(0x0098_090c),
    by_hand: ControlValueSetter::Boolean(false),
    value: KnownCameraControl::WhiteBalance,
};

/// Elsewhere one control is both: mode 0 of AVFoundation is "locked".
#[cfg(not(target_os = "linux"))]
const EXPOSURE: LockControl = LockControl::mode(KnownCameraControl::Exposure);
#[cfg(not(target_os = "linux"))]
const FOCUS: LockControl = LockControl::mode(KnownCameraControl::Focus);
#[cfg(not(target_os = "linux"))]
const WHITE_BALANCE: LockControl = LockControl::mode(KnownCameraControl::WhiteBalance);

#[cfg(not(target_os = "linux"))]
impl LockControl {
    const fn mode(control: KnownCameraControl) -> LockControl {
        LockControl {
            automatic: control,
            by_hand: ControlValueSetter::EnumValue(0),
            value: control,
        }
    }
}

impl NokhwaCamera {
    fn held(&mut self, how: LockControl) -> Setting {
        // Read first: some drivers fall back to a stored value when they are no longer automatic.
        let value = self.value(how.value);
        let is_locked = self.0.set_camera_control(how.automatic, how.by_hand).is_ok();
        if let (true, Some(value)) = (is_locked, value) {
            // Where it cannot be set, the driver keeps the value it had: what it says now is what is written down.
            let _ = self.0.set_camera_control(how.value, ControlValueSetter::Integer(value));
        }
        Setting {
            is_locked,
            value: self.value(how.value),
        }
    }

    fn value(&self, control: KnownCameraControl) -> Option<i64> {
        match self.0.camera_control(control).ok()?.value() {
            ControlValueSetter::Integer(value) | ControlValueSetter::EnumValue(value) => Some(value),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn offered(all: &[(u32, u32, FrameFormat, u32)]) -> Vec<CameraFormat> {
        let format = |(width, height, format, fps): &(u32, u32, FrameFormat, u32)| {
            CameraFormat::new_from(*width, *height, *format, *fps)
        };
        all.iter().map(format).collect()
    }

    #[test]
    fn the_calibrated_size_is_chosen_raw_unless_that_is_slow() {
        let camera = Camera::pinhole(1280, 960, 1000.0, 1000.0, 639.5, 479.5);
        let choose = |all: &[(u32, u32, FrameFormat, u32)]| {
            let chosen = chosen(&offered(all), &camera)?;
            Ok::<_, LiveCameraError>((chosen.width(), chosen.format(), chosen.frame_rate()))
        };
        use FrameFormat::{MJPEG, NV12, YUYV};
        let all = [
            (640, 480, NV12, 30),
            (1280, 720, MJPEG, 60),
            (1280, 960, YUYV, 7),
            (1280, 960, MJPEG, 30),
            (1280, 960, MJPEG, 15),
        ];
        assert_eq!(choose(&all), Ok((1280, MJPEG, 30)));
        assert_eq!(choose(&all[..3]), Ok((1280, YUYV, 7)));
        assert_eq!(choose(&all[..2]), Ok((640, NV12, 30)));
        assert!(
            choose(&all[1..2]).unwrap_err().to_string().contains("1280 × 960"),
            "720 rows are cropped"
        );
    }
}
