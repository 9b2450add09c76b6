//! Boxes, angles, lengths, convex hulls and rigid transforms: the words every other room speaks.

pub mod angle;
pub mod bbox;
pub mod homography;
mod hull;
pub mod length;
mod plane;
pub mod rigid;

pub use bbox::BoxPx;
pub use hull::convex_hull;
pub use plane::{PlaneTriangle, Point2, UnionFind, between, circle, distance, doubled_area, extent, offset, view_axes};
pub use rigid::Rigid;
