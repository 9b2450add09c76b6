//! Boxes, angles, lengths, convex hulls and rigid transforms: the words every other room speaks.

pub mod angle;
mod axis;
pub mod bbox;
pub mod clip;
pub mod homography;
pub mod length;
mod plane;
pub mod rigid;

pub use axis::{NoDirection, SignedAxis};
pub use bbox::BoxPx;
pub use plane::{
    PlaneTriangle, Point2, UnionFind, between, cells_beside, circle, convex_hull, distance, doubled_area, extent,
    nearest_share, offset, stretches, to_segment, view_axes,
};
pub use rigid::Rigid;
