//! Calibration of a camera from photos of a board, or of tags whose places are known: the smallest model that fits, with its uncertainty, or a reason
//! why there is none.

mod board_photo;
mod boards;
mod detect;
mod doubt;
mod error;
mod estimate;
mod film;
mod fit;
mod jackknife;
mod ladder;
mod model;
mod outliers;
mod page;
mod result;
mod sharpness;
mod shutter;
mod summary;
mod target;
mod uncertainty;

pub use board_photo::{BoardPhoto, LEAST_PHOTOS, SeenCorner, UnusedPhoto};
pub use boards::detect_boards;
pub use detect::check;
pub use error::{CalibrationCaution, CalibrationError};
pub use estimate::{calibrate, calibrate_film};
pub use film::{Film, FilmError, look_at_video};
pub use fit::{View, refit};
pub use ladder::CandidateModel;
pub use model::LensModel;
pub use page::page;
pub use result::{COVERAGE, Calibration, PhotoResult};
pub use shutter::Motion;
pub use summary::{CalibrationAnswer, answer, table};
pub use target::Target;
pub use uncertainty::UncertaintyMap;
