//! Where a camera stands, seen from the model.

use nalgebra::Point3;
use serde::{Deserialize, Serialize};

use scaleproof_core::geometry::angle::wrap_360;

/// Where the camera stood, seen from the model's target point.
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
    /// The viewpoint of a camera centre; both points in the model frame, mm.
    pub fn from_camera(centre_mm: Point3<f64>, target_mm: Point3<f64>) -> Viewpoint {
        let d = centre_mm - target_mm;
        Viewpoint {
            azimuth_deg: wrap_360(d.y.atan2(d.x).to_degrees()),
            pitch_deg: d.z.atan2(d.x.hypot(d.y)).to_degrees(),
            distance_mm: d.norm(),
        }
    }

    /// True for finite numbers in the ranges their fields state, and a camera that is not inside the target.
    pub fn is_possible(&self) -> bool {
        (0.0..360.0).contains(&self.azimuth_deg)
            && (-90.0..=90.0).contains(&self.pitch_deg)
            && self.distance_mm > 0.0
            && self.distance_mm.is_finite()
    }

    /// The camera centre in the model frame, mm: the inverse of [`Viewpoint::from_camera`].
    pub fn camera_centre_mm(&self, target_mm: Point3<f64>) -> Point3<f64> {
        let (azimuth, pitch) = (self.azimuth_deg.to_radians(), self.pitch_deg.to_radians());
        let ground = self.distance_mm * pitch.cos();
        let up = self.distance_mm * pitch.sin();
        target_mm + nalgebra::Vector3::new(ground * azimuth.cos(), ground * azimuth.sin(), up)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use scaleproof_core::geometry::angle::turn;

    #[test]
    fn ninety_degrees_is_the_left_side() {
        let v = Viewpoint::from_camera(Point3::new(0.0, 500.0, 64.0), Point3::new(0.0, 0.0, 64.0));
        assert_eq!((v.azimuth_deg, v.pitch_deg, v.distance_mm), (90.0, 0.0, 500.0));
    }

    proptest! {
        #[test]
        fn camera_centres_round_trip(azimuth in 0.0..360.0_f64, pitch in -80.0..80.0_f64, distance in 100.0..3000.0_f64) {
            let target = Point3::new(0.0, 0.0, 64.5);
            let v = Viewpoint { azimuth_deg: azimuth, pitch_deg: pitch, distance_mm: distance };
            let back = Viewpoint::from_camera(v.camera_centre_mm(target), target);
            prop_assert!(turn(back.azimuth_deg, azimuth).abs() < 1e-9);
            prop_assert!((back.pitch_deg - pitch).abs() < 1e-9 && (back.distance_mm - distance).abs() < 1e-9);
        }
    }
}
