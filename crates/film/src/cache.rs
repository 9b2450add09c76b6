//! Cache of decoded frames that may be chosen, so that they need not be decoded twice; the others are decoded again.

use std::collections::{BTreeMap, BTreeSet};

use crate::choose::{Chosen, Refusal, SelectionCriteria};
use crate::tracking::{FrameResult, NoPose};
use scaleproof_video::Planes;

/// Maximum size of the cache, bytes.
const MOST_BYTES: usize = 256 << 20;
/// Least number of frames that fit; of larger ones, as of 8K, none is cached: some bins' best would drop out all the time.
const LEAST_FRAMES: usize = 16;

/// Cached frames by their numbers: those that would be chosen of the frames tracked so far, then those that would be chosen without them, up to a size.
#[derive(Debug)]
pub struct FrameCache {
    most_bytes: usize,
    frames: BTreeMap<u64, Planes>,
    bytes: usize,
}

impl Default for FrameCache {
    fn default() -> FrameCache {
        FrameCache::up_to(MOST_BYTES)
    }
}

impl FrameCache {
    /// Creates an empty cache of a maximum size, bytes.
    pub fn up_to(most_bytes: usize) -> FrameCache {
        FrameCache {
            most_bytes,
            frames: BTreeMap::new(),
            bytes: 0,
        }
    }

    /// Returns the size of the cached frames, bytes.
    pub fn bytes(&self) -> usize {
        self.bytes
    }

    /// Returns the frame of a number.
    pub fn frame(&self, number: u64) -> Option<&Planes> {
        self.frames.get(&number)
    }

    /// Adds the frame that was tracked last, if it may be chosen.
    pub fn add(
        &mut self,
        planes: Planes,
        all: &[FrameResult],
        criteria: &SelectionCriteria,
        choose: impl Fn(&[FrameResult]) -> Vec<Chosen>,
    ) {
        let Some(look) = all.last() else { return };
        let may_be_chosen = matches!(criteria.refusal(look), None | Some(Refusal::MotionUnknown));
        if !may_be_chosen || planes.length() > self.most_bytes / LEAST_FRAMES {
            return;
        }
        self.bytes += planes.length();
        self.frames.insert(look.number, planes);
        if self.bytes > self.most_bytes {
            self.thin(all, choose);
        }
    }

    /// Removes all but the best, up to half of the size, and the last frame, whose motion is not known yet.
    fn thin(&mut self, all: &[FrameResult], choose: impl Fn(&[FrameResult]) -> Vec<Chosen>) {
        let held = all.iter().filter(|look| self.frames.contains_key(&look.number));
        let mut left: Vec<FrameResult> = held.copied().collect();
        let mut best: BTreeSet<u64> = left.last().map(|last| last.number).into_iter().collect();
        let mut bytes = 0;
        while bytes < self.most_bytes / 2 {
            let chosen = choose(&left);
            if chosen.is_empty() {
                break;
            }
            for one in chosen {
                let look = &mut left[one.at];
                look.shows = Err(NoPose::Unsure);
                best.insert(look.number);
                bytes += self.frames.get(&look.number).map_or(0, Planes::length);
            }
        }
        self.frames.retain(|number, _| best.contains(number));
        self.bytes = self.frames.values().map(Planes::length).sum();
    }
}
