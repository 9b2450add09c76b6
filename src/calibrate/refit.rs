//! A camera fitted again, to photos of points whose places are known.

use nalgebra::Point3;

use super::fit;
use super::model::{ALL, LensModel};
use super::view::View;
use crate::camera::Camera;
use crate::geometry::Rigid;

/// A photo of points whose places are known.
#[derive(Debug, Clone)]
pub(crate) struct KnownPoints {
    pub points_mm: Vec<Point3<f64>>,
    /// In the frame of the camera's image.
    pub seen_px: Vec<[f64; 2]>,
    /// `T_camera_points`, about.
    pub pose: Rigid,
}

/// The camera that explains the photos best, in least squares, with the poses free: of a model, from a start, whose other numbers stay. `None` where the fit finds none.
pub(crate) fn refit(model: LensModel, start: &Camera, photos: &[KnownPoints]) -> Option<Camera> {
    let mut numbers = [0.0; ALL];
    numbers[..4].copy_from_slice(&[start.fx, start.fy, start.cx, start.cy]);
    numbers[4..].copy_from_slice(start.distortion());
    let views: Vec<View> = photos
        .iter()
        .map(|photo| View {
            points_mm: photo.points_mm.clone(),
            seen_px: photo.seen_px.clone(),
        })
        .collect();
    let poses = photos.iter().map(|photo| photo.pose).collect();
    let [fx, fy, cx, cy, distortion @ ..] = fit::fit(model, &views, numbers, poses)?.camera;
    let mut found = start.clone().with_distortion(&distortion);
    (found.fx, found.fy, found.cx, found.cy) = (fx, fy, cx, cy);
    found.sigma_px = None;
    Some(found)
}
