//! Boxes, angles, lengths, convex hulls and rigid transforms: the words every other room speaks.

pub(crate) mod angle;
pub(crate) mod bbox;
pub(crate) mod homography;
mod hull;
pub(crate) mod length;
pub(crate) mod rigid;

pub use bbox::BoxPx;
pub(crate) use hull::convex_hull;
pub use rigid::Rigid;

pub(crate) fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}
