//! Surface of a mesh that a pinhole camera sees at the centre of each pixel: which triangle, and how far away.

use std::ops::Range;

use nalgebra::{Point3, Vector3};

use crate::Pinhole;
use scaleproof_core::geometry::{BoxPx, Rigid};
use scaleproof_surface::mesh::{Mesh, doubled_area};
use scaleproof_surface::zbuffer::ZBuffer;

/// Least depth of a corner: nearer, the camera is in the model.
const NEAREST_MM: f64 = 1.0;
/// Least distance of a point behind the plane of a triangle that hides it. Less is the same surface, in other triangles.
const BEHIND_MM: f64 = 1.0;
/// Least difference of depth between the point and that triangle, in pixels' footprints.
const BEHIND_PX: f64 = 3.0;
/// Margin around the model in [`Raster::whole`].
const MARGIN_PX: i64 = 2;

/// Surface that a pixel shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Depth along the camera's axis, mm.
    pub depth_mm: f64,
    /// Index into the mesh's triangles.
    pub triangle: usize,
}

/// Z-buffer of a mesh in one camera. Both sides of a triangle are seen: shells have only one.
pub struct Raster<'a> {
    mesh: &'a Mesh,
    /// `T_camera_model`.
    pose: Rigid,
    pinhole: Pinhole,
    /// Depth (mm) and index of the nearest triangle at each pixel of an image, or of a window that reaches beyond it.
    nearest: ZBuffer<usize>,
}

/// Corner of the mesh in an image: pixel and depth (mm).
type Corner = ([f64; 2], f64);

/// Projects the mesh's corners; `None` when one is not before the camera.
fn corners(mesh: &Mesh, pose: &Rigid, pinhole: &Pinhole) -> Option<Vec<Corner>> {
    let corner = |p: &Point3<f64>| {
        let p = pose * p;
        (p.z >= NEAREST_MM).then(|| (pixel(pinhole, &p), p.z))
    };
    mesh.points().iter().map(corner).collect()
}

/// Returns the box around the mesh's projected corners, pixel (0, 0) is the centre of the top-left pixel; `None` when a corner is not before the camera.
pub fn outline(mesh: &Mesh, pose: &Rigid, pinhole: &Pinhole) -> Option<BoxPx> {
    BoxPx::around(corners(mesh, pose, pinhole)?.into_iter().map(|(pixel, _)| pixel))
}

/// Projects a point of the camera frame.
fn pixel(pinhole: &Pinhole, p: &Point3<f64>) -> [f64; 2] {
    let [cx, cy] = pinhole.centre_px;
    let f = pinhole.focal_length_px;
    [f * p.x / p.z + cx, f * p.y / p.z + cy]
}

/// Returns the point at depth 1 on the ray of a pixel, camera frame.
pub fn ray(pinhole: &Pinhole, [x, y]: [f64; 2]) -> Point3<f64> {
    let [cx, cy] = pinhole.centre_px;
    let f = pinhole.focal_length_px;
    Point3::new((x - cx) / f, (y - cy) / f, 1.0)
}

impl<'a> Raster<'a> {
    /// Draws an image of this size (width, height; px); `None` when part of the mesh is not before the camera.
    pub fn image(mesh: &'a Mesh, pose: &Rigid, pinhole: &Pinhole, size: [usize; 2]) -> Option<Self> {
        let corners = corners(mesh, pose, pinhole)?;
        Some(Self::drawn(
            mesh,
            &corners,
            pose,
            pinhole,
            size.map(|side| 0..side as i64),
        ))
    }

    /// Draws the whole mesh, also what lies beyond the image, up to its width and height on each side.
    pub fn whole(mesh: &'a Mesh, pose: &Rigid, pinhole: &Pinhole, size: [usize; 2]) -> Option<Self> {
        let corners = corners(mesh, pose, pinhole)?;
        let around = BoxPx::around(corners.iter().map(|(pixel, _)| *pixel))?;
        let span = |low: f64, high: f64, size: usize| {
            let (least, most) = (-(size as i64), 2 * size as i64);
            let low = (low.floor() as i64 - MARGIN_PX).clamp(least, most);
            let high = (high.ceil() as i64 + MARGIN_PX).clamp(least, most);
            low..high
        };
        let window = [span(around.x1, around.x2, size[0]), span(around.y1, around.y2, size[1])];
        Some(Self::drawn(mesh, &corners, pose, pinhole, window))
    }

    /// Draws the triangles, each where it is the nearest so far: 1/z is linear in the image.
    fn drawn(
        mesh: &'a Mesh,
        corners: &[Corner],
        pose: &Rigid,
        pinhole: &Pinhole,
        [columns, rows]: [Range<i64>; 2],
    ) -> Self {
        let mut nearest = ZBuffer::new(columns, rows, 0.0);
        for (index, triangle) in mesh.triangles().iter().enumerate() {
            let corners = triangle.corners.map(|corner| corners[corner]);
            let depth_mm = |shares: [f64; 3]| {
                let nearness: f64 = shares.iter().zip(corners).map(|(share, (_, z))| share / z).sum();
                1.0 / nearness
            };
            nearest.draw(corners.map(|(pixel, _)| pixel), depth_mm, |_| index);
        }
        Self {
            mesh,
            pose: *pose,
            pinhole: *pinhole,
            nearest,
        }
    }

    /// Returns the surface at a pixel; `None` beyond the window.
    pub fn at(&self, x: i64, y: i64) -> Option<Hit> {
        self.nearest.at(x, y).map(|nearest| Hit {
            depth_mm: nearest.depth,
            triangle: nearest.item,
        })
    }

    /// Returns the surface point (model frame, mm) at a pixel's centre.
    pub fn point(&self, x: i64, y: i64, hit: &Hit) -> Point3<f64> {
        let ray = ray(&self.pinhole, [x as f64, y as f64]);
        self.pose
            .inverse_transform_point(&Point3::from(ray.coords * hit.depth_mm))
    }

    /// Returns true when this camera sees a point of a triangle (model frame, mm) from the side that another camera's centre lies on, and nothing but
    /// triangles of its kind in the pixels around it: light from there has strayed into a photo's pixel.
    pub fn sees(
        &self,
        point: &Point3<f64>,
        triangle: usize,
        other_centre: &Point3<f64>,
        is_its_kind: impl Fn(usize) -> bool,
    ) -> bool {
        let centre = self.pose.inverse_transform_point(&Point3::origin());
        let corners = self.mesh.corners_mm(&self.mesh.triangles()[triangle]);
        let normal = doubled_area(&corners);
        let side = |eye: &Point3<f64>| normal.dot(&(eye - corners[0])) > 0.0;
        if side(&centre) != side(other_centre) {
            return false;
        }
        let p = self.pose * point;
        if p.z < NEAREST_MM {
            return false;
        }
        let [x, y] = pixel(&self.pinhole, &p).map(|v| v.round() as i64);
        let slack = BEHIND_PX * p.z / self.pinhole.focal_length_px;
        (-1..=1)
            .flat_map(|dy| (-1..=1).map(move |dx| (dx, dy)))
            .all(|(dx, dy)| {
                self.at(x + dx, y + dy).is_some_and(|hit| {
                    let is_nearer = hit.triangle != triangle && hit.depth_mm < p.z - slack;
                    is_its_kind(hit.triangle) && !(is_nearer && self.is_behind(point, hit.triangle, &centre))
                })
            })
    }

    fn is_behind(&self, point: &Point3<f64>, triangle: usize, eye: &Point3<f64>) -> bool {
        let corners = self.mesh.corners_mm(&self.mesh.triangles()[triangle]);
        let normal: Vector3<f64> = doubled_area(&corners).normalize();
        let height = |p: &Point3<f64>| normal.dot(&(p - corners[0]));
        -height(point) * height(eye).signum() > BEHIND_MM
    }
}
