//! The model in its textures as a camera sees it, drawn without Blender: diffuse light from behind the camera's left shoulder, on white.

use image::{Rgb, RgbImage};
use nalgebra::{Point3, Vector3};

use super::Pinhole;
use super::photos::raster::Raster;
use crate::geometry::Rigid;
use crate::mesh::{Mesh, doubled_area};
use crate::pattern::light;
use crate::texture::{SurfacePoint, Texture};

/// Points along each side of a pixel.
const FACTOR: u32 = 3;
/// The share of the light that comes from everywhere.
const AMBIENT: f64 = 0.4;
/// From the surface to the lamp: to the right, down and along the camera's axis.
const LAMP: [f64; 3] = [-0.4, -0.7, -0.6];

/// What is drawn.
pub(crate) struct ShadedModel<'a> {
    pub mesh: &'a Mesh,
    /// Of each material.
    pub textures: Vec<&'a Texture>,
}

impl ShadedModel<'_> {
    /// Each pixel is the mean of its points in linear light. `None` when part of the model is not before the camera.
    pub(crate) fn draw(&self, pose: &Rigid, pinhole: &Pinhole, [width, height]: [u32; 2]) -> Option<RgbImage> {
        let fine = |px: f64| (px + 0.5) * f64::from(FACTOR) - 0.5;
        let finer = Pinhole {
            focal_length_px: pinhole.focal_length_px * f64::from(FACTOR),
            centre_px: pinhole.centre_px.map(fine),
        };
        let size = [width, height].map(|px| (px * FACTOR) as usize);
        let raster = Raster::image(self.mesh, pose, &finer, size)?;
        let colour = |x: u32, y: u32| {
            let mut sum = [0.0; 3];
            for point in 0..FACTOR * FACTOR {
                let (x, y) = (i64::from(x * FACTOR + point % FACTOR), i64::from(y * FACTOR + point / FACTOR));
                let linear = match raster.at(x, y) {
                    Some(hit) => self.shaded(pose, hit.triangle, &raster.point(x, y, &hit)),
                    None => [1.0; 3],
                };
                (0..3).for_each(|c| sum[c] += linear[c] / f64::from(FACTOR * FACTOR));
            }
            Rgb(light::rgb_of(sum))
        };
        Some(RgbImage::from_fn(width, height, colour))
    }

    fn shaded(&self, pose: &Rigid, triangle: usize, place: &Point3<f64>) -> [f64; 3] {
        let corners = self.mesh.corners_mm(&self.mesh.triangles()[triangle]);
        let normal = pose.rotation * doubled_area(&corners).normalize();
        // Both sides of a shell are seen.
        let normal = if normal.dot(&(pose * place).coords) > 0.0 { -normal } else { normal };
        let lit = AMBIENT + (1.0 - AMBIENT) * normal.dot(&Vector3::from(LAMP).normalize()).max(0.0);
        let material = self.mesh.triangles()[triangle].material;
        let at = SurfacePoint {
            triangle,
            weights: weights(&corners, place),
        };
        let rgb = self.textures[material].colour(self.mesh, &at);
        light::linear_of(rgb).map(|v| v * lit)
    }
}

/// The shares of the corners at a point of a triangle.
fn weights(corners: &[Point3<f64>; 3], p: &Point3<f64>) -> [f64; 3] {
    let whole = doubled_area(corners);
    let [a, b, c] = corners;
    let share = |q: &Point3<f64>, r: &Point3<f64>| doubled_area(&[*p, *q, *r]).dot(&whole) / whole.norm_squared();
    let (first, second) = (share(b, c), share(c, a));
    [first, second, 1.0 - first - second]
}
