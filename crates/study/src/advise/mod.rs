//! Advice on a session: each step from a photo to a figure, done in smaller and larger ways on its own photos, and the smallest that is not shown
//! worse.
//!
//! No truth is needed: a pose is judged by how well it predicts the corners of a tag that it was not made of (`held_out.rs`).

mod camera_check; // the camera file against the photos
mod error; // reasons why nothing can be advised
mod figures; // advice on figures
mod held_out; // tags left out and predicted
mod judge; // verdicts on ways
mod measure; // every way on one photo
mod method; // methods of a step
mod page; // the page of an advice
mod paired; // differences of two ways on the same photos
mod poses; // advice on poses
mod result; // what is advised
mod table; // the table of an advice

pub use error::AdviseError;
pub use figures::{FigureAdvice, advise_figures};
pub use held_out::Sample;
pub use method::Question;
pub use page::page;
pub use poses::advise_poses;
pub use result::{Advice, CameraVerdict, Choice, PoseAdvice};
pub use table::{settings, table};
