//! Layers: a layer is a function of arrays with its backward pass.

use std::sync::Arc;

use super::number::Number;

/// Numbers of a tensor, row-major.
pub type Array<T = f32> = Arc<Vec<T>>;

/// A backward pass: from the derivative by a layer's output to those by its inputs.
pub type Back<'a, T = f32> = Box<dyn FnOnce(Vec<T>, &mut Sums<T>) + 'a>;

/// A function of arrays that is differentiated.
pub trait Layer<T: Number = f32>: Send + Sync {
    /// The output, and where `keeps` the backward pass.
    fn forward(&self, inputs: Vec<Array<T>>, keeps: bool) -> (Array<T>, Option<Back<'_, T>>);
}

/// The sums of derivatives that a layer adds to: those by its inputs.
pub struct Sums<'a, T = f32> {
    /// Sum of every slot of the network, where there is one.
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
