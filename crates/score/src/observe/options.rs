//! Options of a run.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use crate::observe::Cache;
use scaleproof_core::workers;
use scaleproof_pose::tags::TagDetectorChoice;

/// Options of a run.
#[derive(Debug)]
pub struct Options {
    /// Number of photos that are observed in parallel.
    pub threads: usize,
    /// Cache of results for the next run.
    pub cache: Option<Cache>,
    /// Tag detector: it changes results, and the cache is opened for it.
    pub tags: TagDetectorChoice,
    /// Set to true from another thread, it ends the run after the photos that are in work.
    pub stop: Arc<AtomicBool>,
}

impl Default for Options {
    fn default() -> Options {
        Options {
            threads: workers::thread_count(),
            cache: None,
            tags: TagDetectorChoice::default(),
            stop: Arc::default(),
        }
    }
}
