//! Layers of a network on plain arrays, for one image: forward, and back with respect to their inputs.
//!
//! Shapes and weights are known when a layer is made, so it keeps for the backward pass only what depends on the image. A layer works on the
//! thread that calls it: whoever has several images gives each a thread.

pub mod activation;
pub mod convolution;
mod depthwise;
pub mod learning;
pub mod lines;
pub mod matrix;
pub mod moved;
pub mod number;
pub mod pairwise;
pub mod pool;
pub mod sampled;
pub mod separate;
pub mod transposed;
pub mod windows;

use std::collections::BTreeSet;
use std::sync::Arc;

pub use activation::{Activation, Each, sigmoid};
pub use convolution::convolution;
pub use lines::{Lines, Reduced, Softmax, Summary};
pub use matrix::Product;
pub use moved::Moved;
pub use number::Number;
pub use pairwise::{Operation, Pairwise};
pub use pool::MaxPool;
pub use sampled::Sampled;
pub use separate::Separate;
pub use transposed::Transposed;
pub use windows::{Weights, Windows};

/// Numbers of a tensor, row-major.
pub type Array<T = f32> = Arc<Vec<T>>;

/// From the derivative by a layer's output to those by its inputs.
pub type Back<'a, T = f32> = Box<dyn FnOnce(Vec<T>, &mut Sums<T>) + 'a>;

pub trait Layer<T: Number = f32>: Send + Sync {
    /// The output, and where `keeps` the backward pass.
    fn forward(&self, inputs: Vec<Array<T>>, keeps: bool) -> (Array<T>, Option<Back<'_, T>>);
}

pub struct Sums<'a, T = f32> {
    /// Of every slot of the network.
    pub all: &'a mut [Option<Vec<T>>],
    pub slots: &'a [usize],
}

impl<T: Number> Sums<'_, T> {
    /// Adds a derivative by an input.
    pub fn add(&mut self, input: usize, derivative: Vec<T>) {
        let sum = &mut self.all[self.slots[input]];
        match sum {
            Some(sum) => vectorised(|| sum.iter_mut().zip(&derivative).for_each(|(sum, d)| *sum += *d)),
            None => *sum = Some(derivative),
        }
    }

    /// The sum itself, of so many numbers, to be added to.
    pub fn sum_mut(&mut self, input: usize, count: usize) -> &mut [T] {
        self.all[self.slots[input]].get_or_insert_with(|| vec![T::ZERO; count])
    }
}

/// For each step, by the slots that it reads: those that no later step and none of `needed` reads, so that a layer may write over what they hold. A
/// slot that a step reads twice is none of them.
pub fn last_uses<'a>(
    reads: impl DoubleEndedIterator<Item = &'a [usize]>,
    needed: impl IntoIterator<Item = usize>,
) -> Vec<BTreeSet<usize>> {
    let mut needed: BTreeSet<usize> = needed.into_iter().collect();
    let last_of = |read: &[usize]| {
        let is_read_once = |slot: &&usize| read.iter().filter(|other| other == slot).count() == 1;
        let last = read.iter().filter(is_read_once).filter(|slot| !needed.contains(slot));
        let last = last.copied().collect();
        needed.extend(read);
        last
    };
    let mut uses: Vec<BTreeSet<usize>> = reads.rev().map(last_of).collect();
    uses.reverse();
    uses
}

/// Runs a loop compiled for the widest vectors of this processor. What is more than a loop implements `pulp::WithSimd`, since the compiler
/// leaves a large closure as it is.
#[inline(always)]
pub fn vectorised<R>(work: impl FnOnce() -> R) -> R {
    pulp::Arch::new().dispatch(work)
}

/// The numbers of an array, the array's own where nobody else reads them.
pub fn owned<T: Clone>(array: Array<T>) -> Vec<T> {
    Arc::try_unwrap(array).unwrap_or_else(|shared| shared.to_vec())
}
