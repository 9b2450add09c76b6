//! Viewpoint of a camera relative to the model.

use nalgebra::Point3;
use serde::{Deserialize, Serialize};

use scaleproof_core::geometry::Rigid;
use scaleproof_core::geometry::angle::wrap_360;

/// Viewpoint of the camera, relative to the model's target point.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Viewpoint {
    /// 0° looks at the front, counter-clockwise from above (90° = the model's left side), in [0, 360).
    pub azimuth_deg: f64,
    /// Elevation above the ground plane, in [-90, 90].
    pub pitch_deg: f64,
    /// Camera centre to target point, at model scale.
    pub distance_mm: f64,
}

impl Viewpoint {
    /// Returns the viewpoint of a camera centre; both points in the model frame, mm.
    pub fn from_camera(centre_mm: Point3<f64>, target_mm: Point3<f64>) -> Viewpoint {
        let d = centre_mm - target_mm;
        Viewpoint {
            azimuth_deg: wrap_360(d.y.atan2(d.x).to_degrees()),
            pitch_deg: d.z.atan2(d.x.hypot(d.y)).to_degrees(),
            distance_mm: d.norm(),
        }
    }

    /// Returns the viewpoint of the pose `T_camera_model` towards a point of the model frame, mm.
    pub fn of_pose(pose: &Rigid, target_mm: Point3<f64>) -> Viewpoint {
        Viewpoint::from_camera(pose.inverse() * Point3::origin(), target_mm)
    }

    /// Returns every combination, in the order a person walks: once round for each elevation at each distance.
    pub fn combinations(azimuths_deg: &[f64], pitches_deg: &[f64], distances_mm: &[f64]) -> Vec<Viewpoint> {
        let mut all = Vec::new();
        for &distance_mm in distances_mm {
            for &pitch_deg in pitches_deg {
                all.extend(azimuths_deg.iter().map(|&azimuth_deg| Viewpoint {
                    azimuth_deg,
                    pitch_deg,
                    distance_mm,
                }));
            }
        }
        all
    }

    /// Returns true for finite numbers in the ranges their fields state, and a camera that is not inside the target.
    pub fn is_possible(&self) -> bool {
        (0.0..360.0).contains(&self.azimuth_deg)
            && (-90.0..=90.0).contains(&self.pitch_deg)
            && self.distance_mm > 0.0
            && self.distance_mm.is_finite()
    }

    /// Returns the camera centre in the model frame, mm: the inverse of [`Viewpoint::from_camera`].
    pub fn camera_centre_mm(&self, target_mm: Point3<f64>) -> Point3<f64> {
        let (azimuth, pitch) = (self.azimuth_deg.to_radians(), self.pitch_deg.to_radians());
        let ground = self.distance_mm * pitch.cos();
        let up = self.distance_mm * pitch.sin();
        target_mm + nalgebra::Vector3::new(ground * azimuth.cos(), ground * azimuth.sin(), up)
    }
}
