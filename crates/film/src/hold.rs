//! Frames that may be chosen, held as they were decoded while the film is looked at, so that it need not be decoded twice. What is not held is decoded again.

use std::collections::BTreeMap;

use crate::choose::{Chosen, Refusal, Wish};
use crate::look::{Look, Unplaced};
use crate::motion::{self, BESIDE};
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
    /// Looks at the held frames, in their order. Motions of the first ones are set.
    looks: Vec<Look>,
    settled: usize,
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
            looks: Vec::new(),
            settled: 0,
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
        self.looks.push(*look);
        if self.bytes > self.most_bytes {
            self.settle(all);
            self.thin(choose);
        }
    }

    /// Sets the motions of frames whose neighbours were looked at, as far as the film tells them yet.
    fn settle(&mut self, all: &[Look]) {
        let Some(first) = self.looks.get(self.settled) else {
            return;
        };
        let from = all.partition_point(|look| look.number < first.number);
        let mut recent = all[from.saturating_sub(BESIDE)..].to_vec();
        motion::set(&mut recent);
        recent.truncate(recent.len().saturating_sub(BESIDE));
        let known: BTreeMap<u64, Look> = recent.into_iter().map(|look| (look.number, look)).collect();
        for look in &mut self.looks[self.settled..] {
            let Some(known) = known.get(&look.number) else { break };
            *look = *known;
            self.settled += 1;
        }
        // All by the same exposure, or they could not be compared.
        motion::set_smears(&mut self.looks[..self.settled]);
    }

    /// Removes all but the best of what is settled, down to half of the length.
    fn thin(&mut self, choose: impl Fn(&[Look]) -> Vec<Chosen>) {
        let mut left = self.looks[..self.settled].to_vec();
        let mut best = vec![false; self.settled];
        let mut bytes = 0;
        while bytes < self.most_bytes / 2 {
            let chosen = choose(&left);
            if chosen.is_empty() {
                break;
            }
            for one in chosen {
                best[one.at] = true;
                left[one.at].shows = Err(Unplaced::Unsure);
                bytes += self.frames.get(&self.looks[one.at].number).map_or(0, Planes::length);
            }
        }
        let mut at = 0;
        self.looks.retain(|look| {
            let stays = best.get(at).copied().unwrap_or(true);
            at += 1;
            if !stays && let Some(planes) = self.frames.remove(&look.number) {
                self.bytes -= planes.length();
            }
            stays
        });
        self.settled = best.iter().filter(|stays| **stays).count();
    }
}
