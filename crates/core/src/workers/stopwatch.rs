//! Time of a photo by stages: each thread's milliseconds, every moment counted for the innermost stage alone.

use std::cell::Cell;
use std::time::Instant;

use serde::Serialize;

/// A part of the work on a photo.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Stage {
    /// The file, its hash, and the luma for the tags.
    Read,
    /// The search for tags.
    Tags,
    /// The pose from the tags.
    Pose,
    /// The colours, at the size that a detector needs.
    Colour,
    /// Resizing to the detector's input.
    Resize,
    /// The detector, to its boxes.
    Network,
    /// The preview and the bookkeeping.
    Rest,
}

impl Stage {
    pub const ALL: [Stage; 7] = [
        Stage::Read,
        Stage::Tags,
        Stage::Pose,
        Stage::Colour,
        Stage::Resize,
        Stage::Network,
        Stage::Rest,
    ];
}

/// Milliseconds of each stage, in the order of [`Stage::ALL`].
pub type StageMs = [f64; Stage::ALL.len()];

thread_local! {
    static SPENT: Cell<StageMs> = const { Cell::new([0.0; Stage::ALL.len()]) };
    /// Milliseconds of the stages inside the present one.
    static INSIDE: Cell<f64> = const { Cell::new(0.0) };
}

/// Does some work, and adds the time it takes to this thread's stage.
pub fn timed<T>(stage: Stage, work: impl FnOnce() -> T) -> T {
    let beside = INSIDE.replace(0.0);
    let start = Instant::now();
    let done = work();
    let all = 1e3 * start.elapsed().as_secs_f64();
    let mut spent = SPENT.get();
    spent[stage as usize] += all - INSIDE.get();
    SPENT.set(spent);
    INSIDE.set(beside + all);
    done
}

/// Returns the milliseconds of this thread's stages since the last call.
pub fn take() -> StageMs {
    INSIDE.set(0.0);
    SPENT.take()
}
