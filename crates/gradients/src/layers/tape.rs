//! Steps between numbered slots: last uses of what slots hold, and the backward pass.

use std::collections::BTreeSet;

use super::layer::{Back, Sums};
use super::number::Number;

/// A place for the numbers of one tensor.
pub type Slot = usize;

/// Returns for each step, given by the slots that it reads, those that no later step and none of `needed` reads, so that a layer may write over what they hold. A
/// slot that a step reads twice is none of them.
pub fn last_uses<'a>(
    reads: impl DoubleEndedIterator<Item = &'a [Slot]>,
    needed: impl IntoIterator<Item = Slot>,
) -> Vec<BTreeSet<Slot>> {
    let mut needed: BTreeSet<Slot> = needed.into_iter().collect();
    let last_of = |read: &[Slot]| {
        let is_read_once = |slot: &&usize| read.iter().filter(|other| other == slot).count() == 1;
        let last = read.iter().filter(is_read_once).filter(|slot| !needed.contains(slot));
        let last = last.copied().collect();
        needed.extend(read);
        last
    };
    let mut uses: Vec<BTreeSet<Slot>> = reads.rev().map(last_of).collect();
    uses.reverse();
    uses
}

/// Takes what a slot holds where this is its last use, else another owner of it.
pub fn taken<V: Clone + Default>(values: &mut [V], slot: Slot, last_uses: &BTreeSet<Slot>) -> V {
    if last_uses.contains(&slot) {
        std::mem::take(&mut values[slot])
    } else {
        values[slot].clone()
    }
}

/// The backward pass of a step that was run.
pub struct Recorded<'a, T = f32> {
    pub output: Slot,
    /// Slots of the derivatives that the step adds to.
    pub slots: &'a [Slot],
    pub back: Back<'a, T>,
}

/// The backward passes of steps, in the order in which these were run.
pub type Tape<'a, T = f32> = Vec<Recorded<'a, T>>;

/// Returns the derivatives by so many slots, where any come back, from those by some of them.
pub fn backward<T: Number>(
    tape: Tape<T>,
    slots: usize,
    derivatives: impl IntoIterator<Item = (Slot, Vec<T>)>,
) -> Vec<Option<Vec<T>>> {
    let mut all: Vec<Option<Vec<T>>> = vec![None; slots];
    for (slot, derivative) in derivatives {
        let (all, slots) = (&mut all, &[slot]);
        Sums { all, slots }.add(0, derivative);
    }
    for Recorded { output, slots, back } in tape.into_iter().rev() {
        // Zeros come back as zeros, at the same cost.
        let gradient = all[output].take();
        if let Some(gradient) = gradient.filter(|g| g.iter().any(|g| *g != T::ZERO)) {
            let all = &mut all;
            back(gradient, &mut Sums { all, slots });
        }
    }
    all
}
