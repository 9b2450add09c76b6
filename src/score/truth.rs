//! Where the model is in a photo: its box, projected through the pose.

use crate::camera::Camera;
use crate::geometry::{BoxPx, Rigid};
use crate::scene::Model;

/// Why a photo with a pose has no truth box.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NoTruth {
    #[error("part of the model's box is behind the camera or beyond the camera model: step back")]
    BeyondCamera,
    #[error("the model is not in the picture")]
    OutOfPicture,
}

/// Points along each edge of the box: distortion bends the edges outwards a little.
const STEPS: usize = 8;

/// The picture's box around the model's projected box, cut at the picture's border, in pixels.
///
/// An upper bound of the true outline: a car does not fill the corners of its box.
pub fn box_from_pose(model: &Model, pose: &Rigid, camera: &Camera) -> Result<BoxPx, NoTruth> {
    let corners = model.box_corners_mm();
    let mut seen = Vec::new();
    for (a, b) in edges() {
        for step in 0..=STEPS {
            let point = corners[a] + (corners[b] - corners[a]) * (step as f64 / STEPS as f64);
            seen.push(camera.project(&(pose * point)).ok_or(NoTruth::BeyondCamera)?);
        }
    }
    BoxPx::around(seen)
        .map(|b| b.clipped(f64::from(camera.width), f64::from(camera.height)))
        .filter(BoxPx::is_solid)
        .ok_or(NoTruth::OutOfPicture)
}

/// The twelve edges, as pairs of corner numbers that differ in one bit.
fn edges() -> impl Iterator<Item = (usize, usize)> {
    (0..8).flat_map(|a| {
        [1, 2, 4]
            .into_iter()
            .filter(move |bit| a & bit == 0)
            .map(move |bit| (a, a | bit))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::rigid;
    use nalgebra::{Matrix3, Vector3};

    fn model() -> Model {
        Model {
            name: "m".into(),
            scale: 10.0,
            class: "car".into(),
            size_mm: [400.0, 200.0, 100.0],
        }
    }

    /// A camera on the model's left at 1100 mm, looking level at its middle.
    fn from_the_left(shift_mm: f64) -> Rigid {
        // Camera x = -model x, camera y = -model z, camera z = -model y.
        let rotation = Matrix3::new(-1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, -1.0, 0.0);
        rigid::from_matrix(rotation, Vector3::new(shift_mm, 50.0, 1100.0))
    }

    #[test]
    fn the_near_side_sets_the_box() {
        let camera = Camera::pinhole(1000, 800, 1000.0, 1000.0, 500.0, 400.0);
        let b = box_from_pose(&model(), &from_the_left(0.0), &camera).unwrap();
        // The near side is 1000 mm away: 400 mm × 100 mm there are 400 × 100 px.
        assert_eq!(
            [b.x1, b.y1, b.x2, b.y2].map(|v| v.round()),
            [300.0, 350.0, 700.0, 450.0]
        );
    }

    #[test]
    fn a_model_outside_the_picture_has_no_box() {
        let camera = Camera::pinhole(1000, 800, 1000.0, 1000.0, 500.0, 400.0);
        assert_eq!(
            box_from_pose(&model(), &from_the_left(5000.0), &camera),
            Err(NoTruth::OutOfPicture)
        );
        let inside = rigid::from_matrix(Matrix3::identity(), Vector3::zeros());
        assert_eq!(box_from_pose(&model(), &inside, &camera), Err(NoTruth::BeyondCamera));
    }

    #[test]
    fn a_box_has_twelve_edges() {
        assert_eq!(edges().count(), 12);
    }
}
