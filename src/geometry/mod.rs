//! Boxes, angles and rigid transforms: the words every other room speaks.

pub mod angle;
pub mod bbox;
pub mod rigid;

pub use bbox::BoxPx;
pub use rigid::Rigid;
