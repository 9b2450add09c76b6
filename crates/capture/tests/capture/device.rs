//! Which of its image sizes a camera is opened at.

use nokhwa::utils::{CameraFormat, FrameFormat};
use scaleproof_capture::live::{LiveCameraError, choose_format};
use scaleproof_pose::camera::Camera;

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
        let chosen = choose_format(&offered(all), &camera)?;
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
