//! Methods compared on the same photos: the charts that choose the defaults, and the sweeps that show where each method breaks.

pub mod capture;
pub mod envelope;
pub mod locate;
pub mod score;
pub mod sigma;
mod spoil;
pub mod stability;
mod truth;

use std::path::Path;

use image::GrayImage;
use schemars::JsonSchema;
use serde::Serialize;

use scaleproof_core::files::{self, FileError};
use scaleproof_core::message::Message;
use scaleproof_core::workers::fastest;
use scaleproof_photo::PhotoError;
use scaleproof_plot::{PlotAxis, Scale, distinct};
use scaleproof_pose::camera::{Camera, SizeError};
use scaleproof_pose::locate::locate_luma;
use scaleproof_pose::scene::Scene;
use scaleproof_pose::tags::{SeenTag, StartError, TagDetector, TagDetectorChoice};
use scaleproof_session::envelope::EnvelopeError;
use scaleproof_session::{Session, SessionError};
pub use spoil::Spoil;
pub use truth::{true_boxes, true_views};

/// Reason why photos could not be measured on.
#[derive(Debug, thiserror::Error)]
pub enum MeasureError {
    #[error(transparent)]
    Tags(#[from] StartError),
    #[error(transparent)]
    Photo(#[from] PhotoError),
    #[error(transparent)]
    Size(#[from] SizeError),
    #[error(transparent)]
    Session(#[from] SessionError),
    #[error(transparent)]
    Mesh(#[from] EnvelopeError),
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Message(#[from] Message),
}

/// The numbers of a chart, with what they were measured with.
#[derive(Debug, Serialize, JsonSchema)]
pub struct ChartNumbers<'a, R> {
    scaleproof: &'static str,
    /// Name of the session; of several, with commas between.
    session: String,
    /// File name and SHA-256.
    inputs: Vec<(String, String)>,
    tag_detectors: Vec<String>,
    rows: &'a [R],
}

impl<'a, R> ChartNumbers<'a, R> {
    /// Takes rows that were measured on a session, and on files besides the session's.
    pub fn new(session: &Session, read: &[&Path], rows: &'a [R]) -> Result<Self, FileError> {
        Self::over(&[session], read, rows)
    }

    /// Takes rows that were measured on several sessions.
    pub fn over(sessions: &[&Session], read: &[&Path], rows: &'a [R]) -> Result<Self, FileError> {
        let others = read
            .iter()
            .map(|path| files::hashed(path))
            .collect::<Result<Vec<_>, _>>()?;
        let detectors = TagDetectorChoice::ALL.iter().chain(&TagDetectorChoice::PEERS);
        Ok(Self {
            scaleproof: env!("CARGO_PKG_VERSION"),
            session: distinct(sessions.iter().map(|session| session.name.as_str())).join(", "),
            inputs: sessions
                .iter()
                .flat_map(|session| session.hashes.clone())
                .chain(others)
                .collect(),
            tag_detectors: detectors.map(|choice| choice.provenance()).collect(),
            rows,
        })
    }
}

/// Finds the tags in an upright photo, which EXIF turned by `turned_deg`; returns them and the milliseconds that it takes.
pub(crate) fn timed_tags(
    choice: TagDetectorChoice,
    detector: &mut dyn TagDetector,
    (luma, turned_deg): (&GrayImage, u32),
    scene: &Scene,
    camera: &Camera,
) -> (Vec<SeenTag>, f64) {
    fastest(|| match choice {
        // The search stops where the pose says so, which is part of its time.
        TagDetectorChoice::Cascade => locate_luma(luma, turned_deg, None, scene, camera, detector).seen,
        _ => detector.find(luma),
    })
}

/// Returns the axis of the time that a photo takes.
pub(crate) fn milliseconds(values: impl IntoIterator<Item = f64>) -> PlotAxis {
    PlotAxis::around("milliseconds a photo, one core", Scale::Log, values)
}
