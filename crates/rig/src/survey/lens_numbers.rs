//! Parameters of a lens that photos of tags may correct.

use nalgebra::{Point3, SMatrix, SVector};

use scaleproof_pose::camera::Camera;
use scaleproof_pose::camera::projection::{PARAMETERS, project_unchecked};

/// Number of these: focal length (share of it), and the first two coefficients of the distortion. A moved principal point is nearly a turned camera.
pub(super) const LENS: usize = 3;
pub(super) type LensNumbers = SVector<f64, LENS>;

/// Computes the derivatives of the pixel of a point of the camera frame by the lens's numbers.
pub(super) fn derivatives(camera: &Camera, point: &Point3<f64>) -> SMatrix<f64, 2, LENS> {
    project_unchecked(&camera.parameters(), point).by_camera * numbers(camera)
}

/// Returns the derivatives of the camera's own numbers by those of the lens.
fn numbers(camera: &Camera) -> SMatrix<f64, PARAMETERS, LENS> {
    let mut numbers = SMatrix::zeros();
    (numbers[(0, 0)], numbers[(1, 0)]) = (camera.fx, camera.fy);
    (numbers[(4, 1)], numbers[(5, 2)]) = (1.0, 1.0);
    numbers
}

pub(super) fn changed(camera: &Camera, by: &LensNumbers) -> Camera {
    let mut parameters = camera.parameters();
    let step = numbers(camera) * by;
    parameters
        .values
        .iter_mut()
        .zip(&step)
        .for_each(|(value, step)| *value += step);
    Camera::from_parameters((camera.width, camera.height), &parameters)
}
