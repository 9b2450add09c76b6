//! Functions of each number by itself.

use std::sync::Arc;

use super::{Array, Back, Layer, Number, Sums, owned, vectorised};

#[derive(Debug, Clone, Copy)]
pub enum Activation {
    Sigmoid,
    /// x·σ(x).
    Silu,
    /// Multiplies x below 0 by this slope.
    LeakyRelu(f64),
}

/// A function that answers with its value and its slope.
pub struct Each<F>(pub F);

impl<T: Number, F: Fn(T) -> (T, T) + Send + Sync> Layer<T> for Each<F> {
    fn forward(&self, mut inputs: Vec<Array<T>>, keeps: bool) -> (Array<T>, Option<Back<'_, T>>) {
        each(inputs.swap_remove(0), keeps, &self.0)
    }
}

impl<T: Number> Layer<T> for Activation {
    fn forward(&self, mut inputs: Vec<Array<T>>, keeps: bool) -> (Array<T>, Option<Back<'_, T>>) {
        let x = inputs.swap_remove(0);
        match *self {
            Activation::Sigmoid => each(x, keeps, |x| {
                let s = sigmoid(x);
                (s, s * (T::ONE - s))
            }),
            Activation::Silu => each(x, keeps, |x| {
                let s = sigmoid(x);
                (x * s, s * (T::ONE + x * (T::ONE - s)))
            }),
            // Not `x < 0`, so that what is not a number stays none.
            Activation::LeakyRelu(below) => {
                let below = T::of(below);
                each(x, keeps, |x| {
                    let slope = if x > T::ZERO { T::ONE } else { below };
                    (slope * x, slope)
                })
            }
        }
    }
}

/// Keeps the slope at each number for the backward pass.
#[inline(always)]
fn each<'a, T: Number>(x: Array<T>, keeps: bool, f: impl Fn(T) -> (T, T)) -> (Array<T>, Option<Back<'a, T>>) {
    let mut y = owned(x);
    if !keeps {
        vectorised(|| y.iter_mut().for_each(|y| *y = f(*y).0));
        return (Arc::new(y), None);
    }
    let mut slopes = vec![T::ZERO; y.len()];
    let both = y.iter_mut().zip(&mut slopes);
    vectorised(|| both.for_each(|(y, slope)| (*y, *slope) = f(*y)));
    let back = move |mut gradient: Vec<T>, sums: &mut Sums<T>| {
        vectorised(|| gradient.iter_mut().zip(&slopes).for_each(|(g, slope)| *g *= *slope));
        sums.add(0, gradient);
    };
    (Arc::new(y), Some(Box::new(back)))
}

#[inline(always)]
pub fn sigmoid<T: Number>(x: T) -> T {
    T::ONE / (T::ONE + (-x).exp())
}
