//! Which tags a camera sees: those that face it, stand in the picture and are not behind the model.

use nalgebra::Point3;

use crate::camera::Camera;
use crate::geometry::Rigid;
use crate::scene::{Scene, Tag};

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
        .any(|corner| is_hidden(scene.model.size_mm, centre, *corner))
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

/// Whether the model's box cuts the line from the camera to a point (slabs: Kay & Kajiya 1986).
fn is_hidden(size_mm: [f64; 3], camera: Point3<f64>, point: Point3<f64>) -> bool {
    let [length, width, height] = size_mm;
    let slabs = [
        (-length / 2.0, length / 2.0),
        (-width / 2.0, width / 2.0),
        (0.0, height),
    ];
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for (axis, (low, high)) in slabs.into_iter().enumerate() {
        let (from, by) = (camera[axis], point[axis] - camera[axis]);
        let (low, high) = (low + SKIN_MM, high - SKIN_MM);
        if by.abs() < 1e-9 {
            if from < low || from > high {
                return false;
            }
            continue;
        }
        let (a, b) = ((low - from) / by, (high - from) / by);
        (enter, leave) = (enter.max(a.min(b)), leave.min(a.max(b)));
    }
    enter < leave
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_model_hides_what_is_behind_it_and_nothing_beside_or_on_it() {
        let (size, camera) = ([455.0, 186.0, 128.0], Point3::new(900.0, 0.0, 200.0));
        assert!(is_hidden(size, camera, Point3::new(-300.0, 0.0, 0.0)));
        assert!(!is_hidden(size, camera, Point3::new(300.0, 0.0, 0.0)));
        assert!(!is_hidden(size, camera, Point3::new(-300.0, 400.0, 0.0)));
        assert!(!is_hidden(size, camera, Point3::new(0.0, 0.0, 128.0)));
    }
}
