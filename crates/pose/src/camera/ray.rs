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
