//! Check of the camera file against the photos: they are split in halves, a camera is refitted to the tags of each, and is judged on the other half.

use nalgebra::{Rotation3, Vector3};

use super::held_out::{MethodResult, Sample, answer};
use super::measure::{Fit, UsualPose};
use super::method::{Question, usual};
use super::paired::{FEWEST_PHOTOS, MARGIN, PairedErrors, PoseShift};
use super::result::{CameraCheck, CameraVerdict};
use scaleproof_core::geometry::Rigid;
use scaleproof_pose::camera::Camera;
use scaleproof_pose::scene::Scene;
use scaleproof_rig::calibrate::{LensModel, View, refit};

/// Model that is fitted again: the numbers that another focus, zoom or lens changes most; the others of the file stay. More of them would fit the
/// noise of half the photos.
const REFITTED: LensModel = LensModel::K1;

/// Ratio that the residuals of photos of one camera stay below: the largest of the stored session is three times the smallest, and every other one
/// zoomed by 3 % has 8 to 20 times its neighbours'.
const TIMES_WORSE: f64 = 4.0;

/// A photo that the usual way locates, and in which it predicts a left-out tag.
pub(super) struct CheckedPhoto<'a> {
    pub sample: &'a Sample,
    pub pose: &'a UsualPose,
    pub by_file: &'a MethodResult,
}

/// Judges the camera file by cameras refitted to halves of the photos. Every other photo is in the other half, so that both go round the model.
/// `None` where the photos are too few, or a half determines no camera. `fits`: of all photos.
pub(super) fn check(photos: &[CheckedPhoto], fits: &[Fit], scene: &Scene, camera: &Camera) -> Option<CameraCheck> {
    if photos.len() < FEWEST_PHOTOS {
        return None;
    }
    let cameras = [refitted(photos, 0, scene, camera)?, refitted(photos, 1, scene, camera)?];
    let way = usual(Question::CameraModel);
    let by_other_half = |(i, photo): (usize, &CheckedPhoto)| {
        let (seen, reference) = (&photo.pose.seen, &photo.pose.reference);
        answer(&way, photo.sample, seen, reference, scene, &cameras[1 - i % 2])
    };
    let refitted: Vec<MethodResult> = photos.iter().enumerate().map(by_other_half).collect();
    let pairs = || photos.iter().map(|photo| photo.by_file).zip(&refitted);
    let paired = PairedErrors::new(pairs());
    let [by_file, by_refitted] = paired.means();
    let better_by_95 = paired.difference_95();
    let moved = PoseShift::between(pairs());
    let is_better = better_by_95.is_some_and(|interval| interval.low > 0.0) && by_file > (1.0 + MARGIN) * by_refitted;
    let verdict = if is_better {
        CameraVerdict::OtherCamera
    } else if no_camera_fits(fits) {
        CameraVerdict::NoCameraFits
    } else {
        CameraVerdict::Fits
    };
    let k1 = |camera: &Camera| camera.distortion().first().copied().unwrap_or(0.0);
    (paired.photos() >= FEWEST_PHOTOS).then(|| CameraCheck {
        photos: paired.photos(),
        held_out_deg: by_file,
        refitted_deg: by_refitted,
        better_by_deg: by_file - by_refitted,
        better_by_95,
        focal_px: camera.fx,
        refitted_focal_px: [cameras[0].fx, cameras[1].fx],
        moved_deg: moved.deg.unwrap_or(0.0),
        moved_mm: moved.mm.unwrap_or(0.0),
        centre_moved_px: [0, 1].map(|i| (cameras[i].cx - camera.cx).hypot(cameras[i].cy - camera.cy)),
        k1: k1(camera),
        refitted_k1: [0, 1].map(|i| k1(&cameras[i])),
        verdict,
    })
}

/// Returns true if tags disagree in a quarter of the photos or more, and fit so much worse there than in the best quarter that noise is no reason.
fn no_camera_fits(fits: &[Fit]) -> bool {
    let mut all: Vec<f64> = fits.iter().filter_map(|fit| fit.rms_px).collect();
    all.sort_by(f64::total_cmp);
    let Some(of_best) = all.get(all.len() / 4) else {
        return false;
    };
    let worse = |fit: &&Fit| fit.disagrees && fit.rms_px.is_some_and(|rms| rms > TIMES_WORSE * of_best);
    let outlying = fits.iter().filter(worse).count();
    outlying >= 2 && 4 * outlying >= fits.len()
}

/// Refits the camera to every other photo, from the first or the second on.
fn refitted(photos: &[CheckedPhoto], first: usize, scene: &Scene, camera: &Camera) -> Option<Camera> {
    let half = photos.iter().skip(first).step_by(2);
    let (views, poses): (Vec<View>, Vec<Rigid>) = half.map(|photo| known_points(photo.pose, scene, camera)).unzip();
    refit(REFITTED, camera, &views, poses)
}

/// Returns the corners of the tags that the pose rests on, and the pose, both in the frame of the camera file's image: the photo's turn is undone.
fn known_points(pose: &UsualPose, scene: &Scene, camera: &Camera) -> (View, Rigid) {
    let (mut points_mm, mut seen_px) = (Vec::new(), Vec::new());
    for seen in &pose.reference {
        if let Some(tag) = scene.tag(seen.family, seen.id) {
            points_mm.extend(tag.corners_mm());
            seen_px.extend(seen.corners_px.map(|at| camera.unfitted_px(&pose.fitted, at)));
        }
    }
    // A clockwise turn is undone: x to the right becomes y upwards.
    let back = Rotation3::from_axis_angle(&Vector3::z_axis(), -f64::from(pose.fitted.turned_deg).to_radians());
    let turned = Rigid::from_parts(nalgebra::Translation3::identity(), back.into()) * pose.located.pose;
    (View { points_mm, seen_px }, turned)
}
