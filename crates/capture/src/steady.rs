//! The last gate of a stream: frames in a row that are fit for the same target.

use super::advice::Advice;

/// Number of frames of a stream in a row that must be fit to be taken at the same target; the last of them is. A fifth of a second at 20 frames a
/// second.
const STEADY_FRAMES: u32 = 4;

/// Condition under which a frame is taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Taking {
    /// Taken when all gates hold.
    ByItself,
    /// Taken whatever its light, focus and steadiness.
    ByHand,
    /// Never taken: it is a small picture of what a device films.
    Never,
}

/// Frames of a stream in a row that are fit for the same target.
#[derive(Debug, Clone)]
pub(crate) struct SteadyRun {
    /// True if frames of a stream are taken by themselves.
    pub is_auto: bool,
    target: usize,
    frames: u32,
}

impl Default for SteadyRun {
    fn default() -> SteadyRun {
        SteadyRun {
            is_auto: true,
            target: 0,
            frames: 0,
        }
    }
}

impl SteadyRun {
    /// Ends the run: the next fit frame is the first.
    pub(crate) fn end(&mut self) {
        self.frames = 0;
    }

    /// Returns true if the next frame would be taken, if it is fit for the same target.
    pub(crate) fn lacks_one(&self) -> bool {
        self.frames > 0 && self.frames + 1 >= STEADY_FRAMES
    }

    /// Adds a frame by its verdict; returns advice if it may not be taken yet.
    pub(crate) fn add(&mut self, verdict: &Result<usize, Advice>, taking: Taking) -> Result<(), Advice> {
        let before = std::mem::take(&mut self.frames);
        let target = *verdict.as_ref().map_err(Advice::clone)?;
        if !self.is_auto {
            return Err(Advice::Ready);
        }
        let frames = 1 + if target == self.target { before } else { 0 };
        if frames >= STEADY_FRAMES && taking != Taking::Never {
            return Ok(());
        }
        (self.target, self.frames) = (target, frames);
        Err(Advice::Hold)
    }
}
