//! Unit and property tests of the plain tools.

#[path = "core/angle.rs"]
mod angle;
#[path = "core/ap.rs"]
mod ap;
#[path = "core/bbox.rs"]
mod bbox;
#[path = "core/bootstrap.rs"]
mod bootstrap;
#[path = "core/clip.rs"]
mod clip;
#[path = "core/files.rs"]
mod files;
#[path = "core/flips.rs"]
mod flips;
#[path = "core/homography.rs"]
mod homography;
#[path = "core/hull.rs"]
mod hull;
#[path = "core/journal.rs"]
mod journal;
#[path = "core/least_squares.rs"]
mod least_squares;
#[path = "core/length.rs"]
mod length;
#[path = "core/medians.rs"]
mod medians;
#[path = "core/normal.rs"]
mod normal;
#[path = "core/place.rs"]
mod place;
#[path = "core/plane.rs"]
mod plane;
#[path = "core/ranks.rs"]
mod ranks;
#[path = "core/rigid.rs"]
mod rigid;
#[path = "core/spelling.rs"]
mod spelling;
#[path = "core/stopwatch.rs"]
mod stopwatch;
#[path = "core/wilson.rs"]
mod wilson;
#[path = "core/workers.rs"]
mod workers;
