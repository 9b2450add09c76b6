//! Frames that may be chosen, held as they were decoded while the film is looked at, so that it need not be decoded twice. What is not held is decoded again.

use std::collections::{BTreeMap, BTreeSet};

use crate::choose::{Chosen, Refusal, Wish};
use crate::look::{Look, Unplaced};
use scaleproof_video::Planes;

/// Frames of so many bytes are held at most.
const MOST_BYTES: usize = 256 << 20;
/// Where fewer fit, as of 8K, none is held: some bins' best would drop out all the time.
const LEAST_FRAMES: usize = 16;

/// Frames by their numbers; of what is looked at so far those that are chosen, and then those that would be chosen without them, up to a length.
#[derive(Debug)]
pub struct Held {
    most_bytes: usize,
    frames: BTreeMap<u64, Planes>,
    bytes: usize,
}

impl Default for Held {
    fn default() -> Held {
        Held::up_to(MOST_BYTES)
    }
}

impl Held {
    /// Nothing yet.
    pub fn up_to(most_bytes: usize) -> Held {
        Held {
            most_bytes,
            frames: BTreeMap::new(),
            bytes: 0,
        }
    }

    /// Bytes of the frames that are held.
    pub fn bytes(&self) -> usize {
        self.bytes
    }

    /// The frame of a number.
    pub fn frame(&self, number: u64) -> Option<&Planes> {
        self.frames.get(&number)
    }

    /// Takes the frame of the last of all looks, where it may be chosen.
    pub fn add(&mut self, planes: Planes, all: &[Look], wish: &Wish, choose: impl Fn(&[Look]) -> Vec<Chosen>) {
        let Some(look) = all.last() else { return };
        let may_be_chosen = matches!(wish.refusal(look), None | Some(Refusal::MotionUnknown));
        if !may_be_chosen || planes.length() > self.most_bytes / LEAST_FRAMES {
            return;
        }
        self.bytes += planes.length();
        self.frames.insert(look.number, planes);
        if self.bytes > self.most_bytes {
            self.thin(all, choose);
        }
    }

    /// Removes all but the best, down to half of the length, and the last frame, whose motion is not known yet.
    fn thin(&mut self, all: &[Look], choose: impl Fn(&[Look]) -> Vec<Chosen>) {
        let held = all.iter().filter(|look| self.frames.contains_key(&look.number));
        let mut left: Vec<Look> = held.copied().collect();
        let mut best: BTreeSet<u64> = left.last().map(|last| last.number).into_iter().collect();
        let mut bytes = 0;
        while bytes < self.most_bytes / 2 {
            let chosen = choose(&left);
            if chosen.is_empty() {
                break;
            }
            for one in chosen {
                let look = &mut left[one.at];
                look.shows = Err(Unplaced::Unsure);
                best.insert(look.number);
                bytes += self.frames.get(&look.number).map_or(0, Planes::length);
            }
        }
        self.frames.retain(|number, _| best.contains(number));
        self.bytes = self.frames.values().map(Planes::length).sum();
    }
}
