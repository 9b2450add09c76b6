//! Scoring runs: photos through pose, truth and detectors, whole or in shards.

pub mod contradicted; // lists of photos that tags contradict
pub mod left_out; // reasons why photos were left out, and the cause that most share
pub(crate) mod record; // detections stored with the sessions
pub(crate) mod score; // the run over all photos
pub mod shard; // a large run in parts
pub mod timed; // times of the stages of the work

pub use left_out::{SessionFiles, explained, not_scored};
pub use record::{check_recordings, record};
pub use score::{merge, observe, score};
pub use timed::{TimedPhoto, timed_photos};
