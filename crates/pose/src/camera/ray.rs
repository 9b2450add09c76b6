//! From a pixel back to the direction that it looks in.

use nalgebra::Vector2;

use super::Camera;
use super::projection::distort;

/// Newton steps; five are enough for lenses that are no fisheyes.
const STEPS: usize = 50;
/// A direction is found when it projects this close to the pixel.
const EXACT_PX: f64 = 1e-6;

impl Camera {
    /// The widest distance from the optical axis, at depth 1, at which [`Camera::project`] answers.
    pub fn widest_radius(&self) -> f64 {
        self.distortion.valid_radius
    }

    /// The point at depth 1 that a pixel shows, by Newton's method from the pinhole's answer; `None` where the lens model ends.
    pub fn point_at(&self, pixel: [f64; 2]) -> Option<[f64; 2]> {
        let target = Vector2::new((pixel[0] - self.cx) / self.fx, (pixel[1] - self.cy) / self.fy);
        let mut found = target;
        for _ in 0..STEPS {
            // What lies beyond the lens model is brought back to its edge.
            let radius = found.norm();
            if radius > self.widest_radius() {
                found *= 0.999 * self.widest_radius() / radius;
            }
            let (at, by_xy) = distort(self.distortion(), found.x, found.y);
            let off = target - Vector2::from(at);
            if (self.fx * off.x).hypot(self.fy * off.y) < EXACT_PX {
                return Some(found.into());
            }
            found += by_xy.try_inverse()? * off;
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point3;
    use proptest::prelude::*;

    proptest! {
        /// Lenses from strong barrel to pincushion, tangential terms too.
        #[test]
        fn a_pixel_looks_where_it_is_seen(
            k1 in -0.25..0.25_f64, k2 in -0.05..0.05_f64, p1 in -0.01..0.01_f64, x in -0.6..0.6_f64, y in -0.45..0.45_f64,
        ) {
            let camera = Camera::pinhole(1280, 960, 1000.0, 990.0, 640.0, 470.0).with_distortion(&[k1, k2, p1, -p1]);
            if let Some(pixel) = camera.project(&Point3::new(x, y, 1.0)) {
                let [u, v] = camera.point_at(pixel).unwrap();
                prop_assert!((u - x).abs() < 1e-8 && (v - y).abs() < 1e-8, "{u} {v}");
            }
        }
    }

    #[test]
    fn a_pixel_beyond_the_lens_model_looks_nowhere() {
        // Barrel distortion so strong that no direction lands further than 770 px from the centre.
        let camera = Camera::pinhole(2000, 2000, 1000.0, 1000.0, 1000.0, 1000.0).with_distortion(&[-0.25]);
        assert!(camera.point_at([1760.0, 1000.0]).is_some());
        assert_eq!(camera.point_at([1999.0, 1000.0]), None);
    }
}
