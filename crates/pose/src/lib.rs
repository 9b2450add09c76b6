//! From a photo to the camera pose: scenes, cameras, boards, AprilTags, pose estimation with its uncertainty, simulated views.
//!
//! [`locate::locate_photo`] is the only way from a photo to its pose. It returns an [`locate::Abstention`] with the reason instead of a pose that may
//! be wrong.
//!
//! ```
//! use std::path::Path;
//! use scaleproof_photo::Photo;
//! use scaleproof_pose::camera::Camera;
//! use scaleproof_pose::locate::locate_photo;
//! use scaleproof_pose::scene::Scene;
//! use scaleproof_pose::tags::TagDetectorChoice;
//!
//! let session = Path::new("../../captures/skyline");
//! let scene = Scene::open(&session.join("scene.toml"))?;
//! let camera = Camera::open(&session.join("camera.yaml"))?;
//! let photo = Photo::open(&session.join("normal_000.jpg"))?;
//! let mut tags = TagDetectorChoice::default().open(&scene.families())?;
//! let located = locate_photo(&photo, &scene, &camera, &mut *tags)?.result?;
//! println!("{:.1}° ± {:.1}°", located.viewpoint.azimuth_deg, located.sigma.azimuth_deg);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod board; // calibration boards of tags or markers
pub mod camera; // camera models and their files
pub mod locate; // from tags to the pose, its uncertainty, or the reason for abstaining
pub mod scene; // the table: model, tags and bins of viewpoints
pub mod simulate; // tags as a camera at a viewpoint sees them, with noise and faults
pub mod tags; // from photo to tag corners

/// Keeps the first items if OpenCV has ArUco in its module `aruco` (before 4.7), the second if it is an object of `objdetect` (since 4.7).
#[cfg(not(opencv_aruco_in_objdetect))]
#[macro_export]
macro_rules! by_opencv {
    (before_4_7 { $($before:item)* } since_4_7 { $($since:item)* }) => { $($before)* };
}

/// Keeps the first items if OpenCV has ArUco in its module `aruco` (before 4.7), the second if it is an object of `objdetect` (since 4.7).
#[cfg(opencv_aruco_in_objdetect)]
#[macro_export]
macro_rules! by_opencv {
    (before_4_7 { $($before:item)* } since_4_7 { $($since:item)* }) => { $($since)* };
}
