//! Repeated Texture Projection (DTA, CVPR 2022, section 3.3): `η_p = M_3Drot · M_scale · M_shift · η_b`, the pattern repeated
//! over a plane that is seen as the camera sees the model.
//!
//! The paper leaves the plane open; here it goes through the target point and faces as that side of the model does which looks to the camera
//! most (of equals the later in [`Side::ALL`]), with the axes and the origin of [`scaleproof_surface::pattern::world_aligned`]. So the tile has its true
//! size at the model's middle, whatever the pose. `M_scale` and `M_shift` are the tile's size and origin with the random scale and shift φ_rd.

use nalgebra::{Matrix3, Point3, Vector3};

use super::world::in_cells;
use super::{Grid, Projection};
use crate::{Coverage, Frame, FrameList};
use scaleproof_surface::pattern::world_aligned::Side;

/// Samples along each side of a pixel.
const PARTS: u32 = 3;

/// Random shift and scale of the texture (φ_rd).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jitter {
    /// Shift to the right and down, in repeats of the pattern.
    pub shift_tiles: [f64; 2],
    /// Size of the pattern relative to its true size.
    pub scale: f64,
}

impl Jitter {
    /// No jitter: the calibrated projection.
    pub const NONE: Self = Self {
        shift_tiles: [0.0, 0.0],
        scale: 1.0,
    };
}

/// Computes the projection for a frame, on the pixels that `paint_mask` covers by half or more.
pub fn project(list: &FrameList, frame: &Frame, paint_mask: &Coverage, grid: &Grid, jitter: &Jitter) -> Projection {
    let to_plane = plane_to_image(list, frame).try_inverse();
    let see = |x: f64, y: f64| {
        let at = to_plane? * Vector3::new(x, y, 1.0);
        // Behind the camera the plane is not seen.
        (at.z > 1e-12).then(|| [at.x / at.z, at.y / at.z])
    };
    let [right, down] = jitter.shift_tiles;
    let (right, down) = (right * f64::from(grid.columns), down * f64::from(grid.rows));
    let pixel = |x: u32, y: u32| {
        if paint_mask.get_pixel(x, y).0[0] < 128 {
            return Vec::new();
        }
        let parts = (0..PARTS * PARTS).map(|i| (i % PARTS, i / PARTS));
        let offset = |part: u32| (f64::from(part) + 0.5) / f64::from(PARTS) - 0.5;
        parts
            .filter_map(|(i, j)| see(f64::from(x) + offset(i), f64::from(y) + offset(j)))
            .map(|uv| {
                let [column, row] = in_cells(grid, uv).map(|cells| cells / jitter.scale);
                [column - right, row - down]
            })
            .collect()
    };
    let [width, height] = list.size_px;
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    Projection::from_points(grid, pixels.map(|(x, y)| pixel(x, y)))
}

/// Returns the homography from the plane's (u, v, 1), mm, to homogeneous pixels, positive in front of the camera.
fn plane_to_image(list: &FrameList, frame: &Frame) -> Matrix3<f64> {
    let (pose, target) = (frame.pose(), Point3::from(list.target_mm));
    let to_camera = pose.inverse().translation.vector - target.coords;
    let facing = |side: &Side| side.outward().dot(&to_camera);
    let sides = Side::ALL.into_iter();
    let side = sides.max_by(|a, b| facing(a).total_cmp(&facing(b)));
    let side = side.unwrap_or(Side::Left);
    let [right, up] = side.axes();
    // A point of the plane is origin + u·right + v·up, with the world-aligned (u, v).
    let [u, v] = side.project(&target);
    let origin = target - u * right - v * up;
    let (f, [cx, cy]) = (list.camera.focal_length_px, list.camera.centre_px);
    let camera = Matrix3::new(f, 0.0, cx, 0.0, f, cy, 0.0, 0.0, 1.0);
    camera * Matrix3::from_columns(&[pose * right, pose * up, (pose * origin).coords])
}
