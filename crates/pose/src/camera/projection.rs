//! Projection of points into the image, with derivatives by point, pose and camera, and of pixels back to viewing directions.
//!
//! OpenCV's pinhole with rational Brown–Conrady distortion (OpenCV documentation, "Camera Calibration and 3D Reconstruction"), or a fisheye
//! (`fisheye.rs`).

use nalgebra::{Matrix2, Matrix2x3, Matrix2x6, Point3, SMatrix, Vector2};

use super::brown_conrady::{self, distort};
use super::distortion::{Distortion, DistortionModel};
use super::fisheye;
use super::model::Camera;
use scaleproof_core::geometry::Rigid;

/// Number of a camera's parameters, including unused coefficients.
pub const PARAMETERS: usize = 12;

/// Intrinsic parameters of a camera, without its image size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameters {
    pub model: DistortionModel,
    /// Values fx, fy, cx, cy (px), then the model's coefficients ([`DistortionModel::names`]); 0 for unused ones.
    pub values: [f64; PARAMETERS],
}

/// Maximum number of Newton steps; five are enough for lenses other than fisheyes.
const NEWTON_STEPS: usize = 50;
/// Convergence threshold: distance between the pixel and the projection of the found direction, px.
const EXACT_PX: f64 = 1e-6;

pub struct ProjectedPoint {
    pub pixel: [f64; 2],
    /// Derivative by the point in the camera frame, px per mm.
    pub by_point: Matrix2x3<f64>,
    /// Derivative by the camera's parameters, in the order of [`Parameters::values`].
    pub by_camera: SMatrix<f64, 2, PARAMETERS>,
}

/// Projects a point of the camera frame by the formula alone, also behind the camera and where the distortion is not invertible. For fits, which pass
/// through such cameras; everything else uses [`Camera::project`].
pub fn project_unchecked(parameters: &Parameters, p: &Point3<f64>) -> ProjectedPoint {
    let [fx, fy, cx, cy, k @ ..] = parameters.values;
    let [x, y] = [p.x / p.z, p.y / p.z];
    let (distorted, by_point) = project_at_focal(parameters.model, &k, [fx, fy], (p, [x, y]));
    let by_k = match parameters.model {
        DistortionModel::BrownConrady => brown_conrady::by_coefficients(&k, x, y),
        DistortionModel::Fisheye => fisheye::by_coefficients(p),
    };
    let mut by_camera = SMatrix::zeros();
    (by_camera[(0, 0)], by_camera[(1, 1)]) = (distorted[0], distorted[1]);
    (by_camera[(0, 2)], by_camera[(1, 3)]) = (1.0, 1.0);
    for (i, [u, v]) in by_k.into_iter().enumerate() {
        (by_camera[(0, 4 + i)], by_camera[(1, 4 + i)]) = (fx * u, fy * v);
    }
    ProjectedPoint {
        pixel: [fx * distorted[0] + cx, fy * distorted[1] + cy],
        by_point,
        by_camera,
    }
}

impl Camera {
    /// Projects a point in the camera frame (mm, x right, y down, z forward) to its pixel. `None` behind the camera and beyond the radius up to which
    /// the distortion model is invertible.
    pub fn project(&self, p: &Point3<f64>) -> Option<[f64; 2]> {
        let [x, y] = self.at_depth_one(p)?;
        Some(self.pixel_of(match self.distortion.model {
            DistortionModel::BrownConrady => distort(&self.distortion.coefficients, x, y).0,
            DistortionModel::Fisheye => fisheye::project(&self.distortion.coefficients, p).0,
        }))
    }

    /// Projects a point in the camera frame (mm) to its pixel, with the derivative by the point, px per mm. `None` where [`Camera::project`] has no
    /// pixel.
    pub fn project_by_point(&self, p: &Point3<f64>) -> Option<([f64; 2], Matrix2x3<f64>)> {
        let xy = self.at_depth_one(p)?;
        let Distortion {
            model, coefficients, ..
        } = &self.distortion;
        let (distorted, by_point) = project_at_focal(*model, coefficients, [self.fx, self.fy], (p, xy));
        Some((self.pixel_of(distorted), by_point))
    }

    /// Projects a point of frame x (mm) under the pose `T_camera_x`, with the derivative by a step of the pose (`geometry::rigid::stepped`): columns
    /// ω (px per rad), υ (px per mm).
    pub fn project_by_pose(&self, pose: &Rigid, point: &Point3<f64>) -> Option<([f64; 2], Matrix2x6<f64>)> {
        self.project_by_step(&(pose * point))
    }

    /// Projects a point in the camera frame (mm), with the derivative by a step of the pose that transformed the point to this frame.
    pub fn project_by_step(&self, p: &Point3<f64>) -> Option<([f64; 2], Matrix2x6<f64>)> {
        let (pixel, by_point) = self.project_by_point(p)?;
        Some((pixel, by_step(&by_point, p)))
    }

    /// Returns the camera's intrinsic parameters.
    pub fn parameters(&self) -> Parameters {
        let [k1, k2, p1, p2, k3, k4, k5, k6] = self.distortion.coefficients;
        Parameters {
            model: self.distortion.model,
            values: [self.fx, self.fy, self.cx, self.cy, k1, k2, p1, p2, k3, k4, k5, k6],
        }
    }

    /// Returns the camera with these parameters for images of a width and a height, px.
    pub fn from_parameters((width, height): (u32, u32), parameters: &Parameters) -> Camera {
        let [fx, fy, cx, cy, k @ ..] = parameters.values;
        Camera {
            distortion: Distortion::new(parameters.model, k),
            ..Camera::pinhole(width, height, fx, fy, cx, cy)
        }
    }

    /// Returns the camera without lens distortion. [`Camera::pixel_of`] of [`Camera::point_at`] converts a pixel of this camera to one of that camera.
    pub(crate) fn straight(&self) -> Camera {
        Camera::pinhole(self.width, self.height, self.fx, self.fy, self.cx, self.cy)
    }

    /// Returns the largest distance from the optical axis, at depth 1, at which [`Camera::project`] has a pixel.
    pub fn widest_radius(&self) -> f64 {
        self.distortion.valid_radius
    }

    /// Returns the point at depth 1 that a pixel shows, by Newton's method from the pinhole's solution; `None` beyond the lens model's range.
    pub fn point_at(&self, pixel: [f64; 2]) -> Option<[f64; 2]> {
        let target = Vector2::new((pixel[0] - self.cx) / self.fx, (pixel[1] - self.cy) / self.fy);
        let coefficients = &self.distortion.coefficients;
        if self.distortion.model == DistortionModel::Fisheye {
            return fisheye::point_at(coefficients, target.into(), self.widest_radius());
        }
        let mut found = target;
        for _ in 0..NEWTON_STEPS {
            // An iterate beyond the lens model's range is moved back to its edge.
            let radius = found.norm();
            if radius > self.widest_radius() {
                found *= 0.999 * self.widest_radius() / radius;
            }
            let (at, by_xy) = distort(coefficients, found.x, found.y);
            let off = target - Vector2::from(at);
            if (self.fx * off.x).hypot(self.fy * off.y) < EXACT_PX {
                return Some(found.into());
            }
            found += by_xy.try_inverse()? * off;
        }
        None
    }

    /// Returns a point's normalised coordinates; `None` behind the camera and beyond the lens model's range.
    fn at_depth_one(&self, p: &Point3<f64>) -> Option<[f64; 2]> {
        let (x, y, widest) = (p.x / p.z, p.y / p.z, self.widest_radius());
        (p.z > 0.0 && x * x + y * y <= widest * widest).then_some([x, y])
    }

    /// Returns the pixel of coordinates at depth 1, by the pinhole intrinsics alone.
    pub(crate) fn pixel_of(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.fx * x + self.cx, self.fy * y + self.cy]
    }
}

/// Returns the derivative of a pixel by a step of the pose, from the derivative by the point `p` of the camera frame.
pub fn by_step(by_point: &Matrix2x3<f64>, p: &Point3<f64>) -> Matrix2x6<f64> {
    let [u, v] = [0, 1].map(|row| [by_point[(row, 0)], by_point[(row, 1)], by_point[(row, 2)]]);
    // The point moves by ω × p: each row of the derivative by ω is p × row.
    let by_turn = |[x, y, z]: [f64; 3]| [p.y * z - p.z * y, p.z * x - p.x * z, p.x * y - p.y * x];
    let ([a, b, c], [d, e, f]) = (by_turn(u), by_turn(v));
    Matrix2x6::new(a, b, c, u[0], u[1], u[2], d, e, f, v[0], v[1], v[2])
}

/// Distorts a point with the normalised coordinates x and y; returns its image in focal lengths from the principal point, and the derivative of its
/// pixel by the point.
fn project_at_focal(
    model: DistortionModel,
    k: &[f64; 8],
    [fx, fy]: [f64; 2],
    (p, [x, y]): (&Point3<f64>, [f64; 2]),
) -> ([f64; 2], Matrix2x3<f64>) {
    match model {
        DistortionModel::BrownConrady if *k == [0.0; 8] => {
            ([x, y], by_point([fx, fy], [x, y], p.z, &Matrix2::identity()))
        }
        DistortionModel::BrownConrady => {
            let (distorted, by_xy) = distort(k, x, y);
            (distorted, by_point([fx, fy], [x, y], p.z, &by_xy))
        }
        DistortionModel::Fisheye => {
            let (distorted, by_point) = fisheye::project(k, p);
            (distorted, Matrix2::new(fx, 0.0, 0.0, fy) * by_point)
        }
    }
}

fn by_point([fx, fy]: [f64; 2], [x, y]: [f64; 2], z: f64, by_xy: &Matrix2<f64>) -> Matrix2x3<f64> {
    let (ux, uy) = (fx * by_xy[(0, 0)], fx * by_xy[(0, 1)]);
    let (vx, vy) = (fy * by_xy[(1, 0)], fy * by_xy[(1, 1)]);
    Matrix2x3::new(ux, uy, -(ux * x + uy * y), vx, vy, -(vx * x + vy * y)) * z.recip()
}
