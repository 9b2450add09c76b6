//! Tag detection, from photo to tag corners, and the images of tags and markers.

mod appearance;
mod apriltag_c;
mod blur;
pub mod border;
mod cascade;
mod choice;
mod detector;
mod edge;
mod expected;
mod fit;
mod homography;
pub mod inset;
mod legibility;
mod likeness;
mod merge;
mod missing;
mod modules;
mod open;
mod part;
mod refine;
#[cfg(feature = "full")]
mod rivals;
#[cfg(not(feature = "full"))]
#[path = "no_rivals.rs"]
mod rivals;
mod search;
mod seen;
mod tag_image;

pub use appearance::{Appearance, edge_blurs, paper_levels};
pub use apriltag_c::AprilTagC;
pub use blur::{EdgeBlur, HOPELESS_BLUR_PX, limit_scale, sharpest_edges_px, worst_px as worst_blur_px};
pub use cascade::{Cascade, CoarseToFine};
pub use choice::{CornersBy, StartError, TagDetectorChoice};
pub use detector::TagDetector;
pub use homography::TagHomography;
pub use missing::{ExpectedTag, StillMissing};
pub use modules::Modules;
pub use rivals::*;
pub use search::{enlarged, least_reduction, library_reduction};
pub use seen::{SeenTag, middle_px, sides_px};
pub use tag_image::TagImage;
