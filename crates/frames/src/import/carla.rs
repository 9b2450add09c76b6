//! CARLA's poses: metres and degrees in Unreal's left-handed frame, x forward, y right, z up.

use nalgebra::{Matrix3, Vector3};

use scaleproof_core::geometry::rigid::{self, Rigid};

/// Pose of an actor, as `actor.get_transform()` returns it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transform {
    pub place_m: [f64; 3],
    /// Pitch (nose up), yaw (clockwise seen from above) and roll (leaning to the right).
    pub angles_deg: [f64; 3],
}

impl Transform {
    pub fn is_finite(&self) -> bool {
        self.place_m.iter().chain(&self.angles_deg).all(|v| v.is_finite())
    }

    /// Returns the rotation from the actor's frame into the world's, both left-handed (`carla.Transform.get_matrix`).
    fn rotation(&self) -> Matrix3<f64> {
        let [(sp, cp), (sy, cy), (sr, cr)] = self.angles_deg.map(|deg| deg.to_radians().sin_cos());
        Matrix3::new(
            cp * cy,
            cy * sp * sr - sy * cr,
            -cy * sp * cr - sy * sr,
            cp * sy,
            sy * sp * sr + cy * cr,
            -sy * sp * cr + cy * sr,
            sp,
            -cp * sr,
            cp * cr,
        )
    }
}

/// Returns `T_camera_model` (mm): the model frame is the vehicle's with y to the left, the camera frame is OpenCV's.
pub fn pose(camera: &Transform, vehicle: &Transform) -> Rigid {
    let (to_world, from_vehicle) = (camera.rotation(), vehicle.rotation());
    let camera_place = from_vehicle.transpose() * (Vector3::from(camera.place_m) - Vector3::from(vehicle.place_m));
    let flip = Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, 1.0));
    // OpenCV's x, y, z are CARLA's y (right), −z (down) and x (forward).
    let axes = Matrix3::new(0.0, 1.0, 0.0, 0.0, 0.0, -1.0, 1.0, 0.0, 0.0);
    let rotation = axes * to_world.transpose() * from_vehicle * flip;
    let centre_mm = 1000.0 * flip * camera_place;
    rigid::from_matrix(rotation, -(rotation * centre_mm))
}
