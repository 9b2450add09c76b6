//! Boxes, angles, lengths, convex hulls and rigid transforms: the words every other room speaks.

pub mod angle;
pub mod bbox;
pub mod homography;
mod hull;
pub mod length;
pub mod rigid;

pub use bbox::BoxPx;
pub use hull::convex_hull;
pub use rigid::Rigid;

pub fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}
