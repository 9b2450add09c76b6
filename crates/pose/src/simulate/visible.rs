//! Which tags a camera sees: those that face it, stand in the image and are not behind the model.

use nalgebra::Point3;

use crate::camera::Camera;
use crate::scene::{Scene, Tag};
use scaleproof_core::geometry::Rigid;

/// Cosine of the angle between a tag's normal and the line of sight below which no detector reads it.
const GRAZING: f64 = 0.2;
/// The model's box is taken smaller by this on each side, so that it does not hide what lies on it, mm.
const SKIN_MM: f64 = 1.0;

/// The visible tags with the pixels of their corners.
pub(super) fn tags<'a>(scene: &'a Scene, camera: &Camera, pose: &Rigid) -> Vec<(&'a Tag, [[f64; 2]; 4])> {
    let visible = |tag| Some((tag, pixels(tag, scene, camera, pose)?));
    scene.tags.iter().filter_map(visible).collect()
}

/// The pixels of a tag's corners; `None` when it is not visible.
pub(super) fn pixels(tag: &Tag, scene: &Scene, camera: &Camera, pose: &Rigid) -> Option<[[f64; 2]; 4]> {
    let centre = pose.inverse() * Point3::origin();
    let to_camera = (centre - tag.centre_mm).normalize();
    if tag.right.cross(&tag.up).dot(&to_camera) < GRAZING {
        return None;
    }
    let corners = tag.corners_mm();
    if corners
        .iter()
        .any(|corner| scene.model.hides(*corner, centre, -SKIN_MM))
    {
        return None;
    }
    let mut pixels = [[0.0; 2]; 4];
    for (pixel, corner) in pixels.iter_mut().zip(&corners) {
        *pixel = camera.project(&(pose * corner))?;
    }
    let inside =
        |[x, y]: &[f64; 2]| (0.0..f64::from(camera.width)).contains(x) && (0.0..f64::from(camera.height)).contains(y);
    pixels.iter().all(inside).then_some(pixels)
}
