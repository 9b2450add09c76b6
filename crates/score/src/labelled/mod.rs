//! AP of a detector on photos whose objects are all labelled, as its origin computed it; and changes of the manifest that explain another figure.

pub mod coco; // COCO annotations of whole photos
pub mod error; // photos that the detector cannot be run on
pub mod feeding; // common ways to feed a network otherwise
pub mod photos; // labelled photos, and the AP on them
pub(crate) mod trials; // a manifest with one thing changed at a time

pub use coco::labelled_photos;
pub use error::LabelledError;
pub use photos::{Averages, LabelledPhotos};
pub use trials::{LEAST_GAIN, Trial, Trials, trials};
