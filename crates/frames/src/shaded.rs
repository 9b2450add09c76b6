//! The model in its textures as a camera sees it, drawn without Blender: diffuse light from behind the camera's left shoulder, on white.

use image::imageops::replace;
use image::{Rgb, RgbImage};
use nalgebra::{Point3, Vector3};

use crate::Pinhole;
use crate::raster::{Raster, outline};
use scaleproof_core::geometry::Rigid;
use scaleproof_core::message::{Message, ensure, message};
use scaleproof_pose::scene::Viewpoint;
use scaleproof_pose::simulate::looking_at;
use scaleproof_surface::mesh::{Mesh, doubled_area};
use scaleproof_surface::pattern::light;
use scaleproof_surface::texture::{SurfacePoint, Texture};

/// Samples along each side of a pixel.
const FACTOR: u32 = 3;
/// Share of the light that is ambient.
const AMBIENT: f64 = 0.4;
/// Direction from the surface to the lamp, camera frame (OpenCV).
const LAMP: [f64; 3] = [-0.4, -0.7, -0.6];

/// Horizontal field of view of a view from around.
pub const FIELD_OF_VIEW_DEG: f64 = 30.0;
/// Largest share of the image's width or height that the model takes while it is turned.
const FILLED: f64 = 0.94;
/// Azimuths at which that share is measured.
const TURNS: u32 = 24;

/// Bisections of the interval of the distance.
const STEPS: usize = 8;

/// A mesh and the texture of each of its materials.
pub struct ShadedModel<'a> {
    pub mesh: &'a Mesh,
    pub textures: Vec<&'a Texture>,
}

impl ShadedModel<'_> {
    /// Draws the whole model from some azimuths, all at the least distance from which it is whole from any azimuth at this pitch. Returns the images
    /// and the distance to the model's middle, mm. `on_view` is called after each.
    pub fn around(
        &self,
        azimuths_deg: &[f64],
        pitch_deg: f64,
        size_px: [u32; 2],
        on_view: impl Fn(),
    ) -> Result<(Vec<RgbImage>, f64), Message> {
        let [width, height] = size_px;
        ensure!(
            size_px.iter().all(|px| (16..=4096).contains(px)),
            "the sides of a view are 16 to 4096 px, not {width} × {height}"
        );
        let pinhole = Pinhole::with_field_of_view(size_px, FIELD_OF_VIEW_DEG);
        let pose = |azimuth_deg, distance_mm| pose_around(self.mesh, azimuth_deg, pitch_deg, distance_mm);
        let is_whole = |distance_mm: f64| {
            let mut turns = (0..TURNS).map(|i| 360.0 * f64::from(i) / f64::from(TURNS));
            turns.all(|turn| {
                outline(self.mesh, &pose(turn, distance_mm), &pinhole).is_some_and(|b| {
                    [(0, b.x1, b.x2), (1, b.y1, b.y2)].into_iter().all(|(axis, low, high)| {
                        let middle = pinhole.centre_px[axis];
                        (middle - low).max(high - middle) / (0.5 * f64::from(size_px[axis])) <= FILLED
                    })
                })
            })
        };
        let (mut near, mut far) = (
            radius_mm(self.mesh),
            distance_of_whole(self.mesh, FILLED, &pinhole, size_px),
        );
        for _ in 0..STEPS {
            let distance_mm = 0.5 * (near + far);
            if is_whole(distance_mm) {
                far = distance_mm;
            } else {
                near = distance_mm;
            }
        }
        let image = |azimuth_deg: &f64| {
            let image = (pitch_deg.abs() <= 89.0).then(|| self.draw(&pose(*azimuth_deg, far), &pinhole, size_px));
            on_view();
            let bad = || message!("a pitch of {pitch_deg}° cannot be drawn; give -89 to 89");
            image.flatten().ok_or_else(bad)
        };
        Ok((azimuths_deg.iter().map(image).collect::<Result<_, _>>()?, far))
    }

    /// Draws a view, each pixel the mean of its samples in linear light; `None` when part of the model is not before the camera.
    pub fn draw(&self, pose: &Rigid, pinhole: &Pinhole, [width, height]: [u32; 2]) -> Option<RgbImage> {
        let size = [width, height].map(|px| (px * FACTOR) as usize);
        let raster = Raster::image(self.mesh, pose, &pinhole.finer(FACTOR), size)?;
        let colour = |x: u32, y: u32| {
            let mut sum = [0.0; 3];
            for point in 0..FACTOR * FACTOR {
                let [x, y] = [x * FACTOR + point % FACTOR, y * FACTOR + point / FACTOR].map(i64::from);
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
        let normal = if normal.dot(&(pose * place).coords) > 0.0 {
            -normal
        } else {
            normal
        };
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

fn radius_mm(mesh: &Mesh) -> f64 {
    let (low, high) = mesh.bounds_mm();
    0.5 * (high - low).norm()
}

/// Returns the distance from which the ball around a mesh takes a share of an image's shorter side, mm.
pub(crate) fn distance_of_whole(mesh: &Mesh, share: f64, pinhole: &Pinhole, [width, height]: [u32; 2]) -> f64 {
    let half_angle = (0.5 * share * f64::from(width.min(height)) / pinhole.focal_length_px).atan();
    radius_mm(mesh) / half_angle.sin()
}

/// Returns the pose of a camera that looks at the middle of a mesh.
pub(crate) fn pose_around(mesh: &Mesh, azimuth_deg: f64, pitch_deg: f64, distance_mm: f64) -> Rigid {
    let (low, high) = mesh.bounds_mm();
    let viewpoint = Viewpoint {
        azimuth_deg,
        pitch_deg,
        distance_mm,
    };
    looking_at(&viewpoint, nalgebra::center(&low, &high))
}

/// Puts views of one size in rows of up to `columns`, on white.
pub fn side_by_side(views: &[RgbImage], columns: usize) -> RgbImage {
    let (width, height) = views.first().map_or((1, 1), RgbImage::dimensions);
    let columns = views.len().clamp(1, columns);
    let rows = views.len().div_ceil(columns);
    let mut all = RgbImage::from_pixel(width * columns as u32, height * rows as u32, Rgb([255; 3]));
    for (i, view) in views.iter().enumerate() {
        let (column, row) = ((i % columns) as i64, (i / columns) as i64);
        replace(&mut all, view, column * i64::from(width), row * i64::from(height));
    }
    all
}

/// Returns the barycentric weights of a point of a triangle.
fn weights(corners: &[Point3<f64>; 3], p: &Point3<f64>) -> [f64; 3] {
    let whole = doubled_area(corners);
    let [a, b, c] = corners;
    let share = |q: &Point3<f64>, r: &Point3<f64>| doubled_area(&[*p, *q, *r]).dot(&whole) / whole.norm_squared();
    let (first, second) = (share(b, c), share(c, a));
    [first, second, 1.0 - first - second]
}
