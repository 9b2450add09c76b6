//! Layers of a network on plain arrays of 32 bits, for one image: forward, and back with respect to their inputs alone.
//!
//! Shapes and weights are known when a layer is made, so it keeps for the backward pass only what depends on the image. A layer works on the
//! thread that calls it: whoever has several images gives each a thread.

pub mod activation;
mod convolution;
mod depthwise;
pub mod learning;
mod moved;
mod pairwise;
mod pool;
mod separate;
mod windows;

use std::sync::Arc;

pub(super) use activation::Activation;
pub(super) use convolution::convolution;
pub(super) use moved::Moved;
pub(super) use pairwise::{Operation, Pairwise};
pub(super) use pool::MaxPool;
pub(super) use separate::Separate;
pub(super) use windows::{Weights, Windows};

/// Numbers of a tensor, row-major.
pub(super) type Array = Arc<Vec<f32>>;

/// From the derivative by a layer's output to those by its inputs.
pub(super) type Back<'a> = Box<dyn FnOnce(Vec<f32>, &mut Sums) + 'a>;

pub(super) trait Layer: Send + Sync {
    /// The output, and where `keeps` the backward pass.
    fn forward(&self, inputs: Vec<Array>, keeps: bool) -> (Array, Option<Back<'_>>);
}

pub(super) struct Sums<'a> {
    /// Of every slot of the network.
    pub all: &'a mut [Option<Vec<f32>>],
    pub slots: &'a [usize],
}

impl Sums<'_> {
    /// Adds a derivative by an input.
    pub(super) fn add(&mut self, input: usize, derivative: Vec<f32>) {
        let sum = &mut self.all[self.slots[input]];
        match sum {
            Some(sum) => vectorised(|| sum.iter_mut().zip(&derivative).for_each(|(sum, d)| *sum += d)),
            None => *sum = Some(derivative),
        }
    }

    /// The sum itself, of so many numbers, to be added to.
    pub(super) fn sum_mut(&mut self, input: usize, count: usize) -> &mut [f32] {
        self.all[self.slots[input]].get_or_insert_with(|| vec![0.0; count])
    }
}

/// Runs a loop compiled for the widest vectors of this processor. What is more than a loop implements `pulp::WithSimd`, since the compiler
/// leaves a large closure as it is.
#[inline(always)]
fn vectorised<R>(work: impl FnOnce() -> R) -> R {
    pulp::Arch::new().dispatch(work)
}

/// The numbers of an array, the array's own where nobody else reads them.
pub(super) fn owned(array: Array) -> Vec<f32> {
    Arc::try_unwrap(array).unwrap_or_else(|shared| shared.to_vec())
}
