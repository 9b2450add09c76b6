//! Observation of photos: tags, detections, a preview. All that is slow is in here, and all of it can be cached.

pub mod cache; // results kept from run to run
pub mod decoded; // colours of a photo at the sizes that detectors take
pub mod job; // one photo of a run
pub mod observation; // all that a run needs of the pixels of a photo
pub mod observer; // tags and detections of one photo after another, on one thread
pub mod options; // threads, cache, tag detector, and a way to stop
pub mod place; // ground truth box and pose of a photo
pub mod preview; // small JPEGs for the report

pub use cache::{Cache, Key};
pub(crate) use decoded::DecodedPhoto;
pub(crate) use job::ScoringJob;
pub use observation::{NotScoredReason, Observation};
pub(crate) use observer::{ObserveError, Observer, PhotoPart};
pub use options::Options;
pub(crate) use place::{PlacedModel, place};
