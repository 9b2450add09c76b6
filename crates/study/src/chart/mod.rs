//! Methods against each other, measured on the same photos: the charts that choose the defaults, and the sweeps that show where
//! each method breaks.

pub mod capture;
pub mod envelope;
pub mod locate;
pub mod score;
mod spoil;
pub mod stability;
mod truth;

use image::GrayImage;

use scaleproof_core::workers::fastest;
use scaleproof_photo::photo::PhotoError;
use scaleproof_plot::{PlotAxis, Scale};
use scaleproof_pose::camera::{Camera, SizeError};
use scaleproof_pose::locate::locate_luma;
use scaleproof_pose::scene::Scene;
use scaleproof_pose::tags::{SeenTag, StartError, TagDetector, TagDetectorChoice};
pub use spoil::Spoil;
pub use truth::{true_boxes, true_views};

/// Why photos could not be measured on.
#[derive(Debug, thiserror::Error)]
pub enum MeasureError {
    #[error(transparent)]
    Tags(#[from] StartError),
    #[error(transparent)]
    Photo(#[from] PhotoError),
    #[error(transparent)]
    Size(#[from] SizeError),
}

/// The tags in an upright photo, which EXIF turned by `turned_deg`, and the milliseconds that finding them takes.
pub(crate) fn timed_tags(
    choice: TagDetectorChoice,
    detector: &mut dyn TagDetector,
    (luma, turned_deg): (&GrayImage, u32),
    (scene, camera): (&Scene, &Camera),
) -> (Vec<SeenTag>, f64) {
    fastest(|| match choice {
        // It stops where the pose says so, which is part of its time.
        TagDetectorChoice::Cascade => locate_luma(luma, turned_deg, scene, camera, detector).seen,
        _ => detector.find(luma),
    })
}

/// The axis of the time that a photo takes.
pub(crate) fn milliseconds(values: impl IntoIterator<Item = f64>) -> PlotAxis {
    PlotAxis::around("milliseconds a photo, one core", Scale::Log, values)
}
