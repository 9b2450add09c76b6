//! Two arrays, number by number; either may be a constant.

use std::sync::Arc;

use super::{Array, Back, Layer, Number, Sums, owned, vectorised};

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Operation {
    Sum,
    Difference,
    Product,
    Quotient,
    Power,
    Largest,
    Smallest,
}

pub struct Pairwise<T = f32> {
    pub operation: Operation,
    /// In place of the first array or of the second.
    pub constants: [Option<Array<T>>; 2],
}

#[inline(always)]
fn by<T: Number>(mut a: Vec<T>, b: &[T], f: impl Fn(T, T) -> T) -> Vec<T> {
    vectorised(|| a.iter_mut().zip(b).for_each(|(a, b)| *a = f(*a, *b)));
    a
}

#[inline(always)]
fn by_both<T: Number>(mut g: Vec<T>, [a, b]: &[Array<T>; 2], f: impl Fn(T, T, T) -> T) -> Vec<T> {
    let both = a.iter().zip(b.iter());
    vectorised(|| g.iter_mut().zip(both).for_each(|(g, (a, b))| *g = f(*g, *a, *b)));
    g
}

fn power<T: Number>(a: T, b: T) -> T {
    T::of(a.wide().powf(b.wide()))
}

impl Operation {
    fn apply<T: Number>(self, a: Array<T>, b: &[T]) -> Vec<T> {
        let a = owned(a);
        match self {
            Operation::Sum => by(a, b, |a, b| a + b),
            Operation::Difference => by(a, b, |a, b| a - b),
            Operation::Product => by(a, b, |a, b| a * b),
            Operation::Quotient => by(a, b, |a, b| a / b),
            Operation::Power => by(a, b, power),
            Operation::Largest => by(a, b, |a, b| a.larger(b)),
            Operation::Smallest => by(a, b, |a, b| if b < a { b } else { a }),
        }
    }

    /// Returns the derivative by the first array or by the second from that by the result.
    fn derivative<T: Number>(self, by_second: bool, g: Vec<T>, arrays: &[Array<T>; 2]) -> Vec<T> {
        let [a, b] = arrays;
        match (self, by_second) {
            (Operation::Sum, _) | (Operation::Difference, false) => g,
            (Operation::Difference, true) => g.into_iter().map(|g| -g).collect(),
            (Operation::Product, false) => by(g, b, |g, b| g * b),
            (Operation::Product, true) => by(g, a, |g, a| g * a),
            (Operation::Quotient, false) => by(g, b, |g, b| g / b),
            (Operation::Quotient, true) => by_both(g, arrays, |g, a, b| -(g * a) / (b * b)),
            (Operation::Power, false) => by_both(g, arrays, |g, a, b| g * b * power(a, b - T::ONE)),
            (Operation::Power, true) => by_both(g, arrays, |g, a, b| g * power(a, b) * T::of(a.wide().ln())),
            (Operation::Largest, _) => by_both(g, arrays, |g, a, b| if (b > a) == by_second { g } else { T::ZERO }),
            (Operation::Smallest, _) => by_both(g, arrays, |g, a, b| if (b < a) == by_second { g } else { T::ZERO }),
        }
    }
}

impl<T: Number> Pairwise<T> {
    /// Creates one of two arrays.
    pub fn new(operation: Operation) -> Self {
        let constants = [None, None];
        Pairwise { operation, constants }
    }

    /// The arrays that derivatives are computed with: of a linear function its constant alone.
    fn kept(&self, a: &Array<T>, b: &Array<T>) -> [Array<T>; 2] {
        let is_linear = match self.operation {
            Operation::Sum | Operation::Difference => true,
            Operation::Product => self.constants.iter().any(Option::is_some),
            Operation::Quotient => self.constants[1].is_some(),
            _ => false,
        };
        if is_linear {
            self.constants.clone().map(Option::unwrap_or_default)
        } else {
            [a.clone(), b.clone()]
        }
    }
}

impl<T: Number> Layer<T> for Pairwise<T> {
    fn forward(&self, inputs: Vec<Array<T>>, keeps: bool) -> (Array<T>, Option<Back<'_, T>>) {
        let mut inputs = inputs.into_iter();
        let [a, b] = self.constants.each_ref().map(|constant| match constant {
            Some(constant) => constant.clone(),
            None => inputs.next().unwrap_or_default(),
        });
        let kept = keeps.then(|| self.kept(&a, &b));
        let result = self.operation.apply(a, &b);
        let back = kept.map(|kept| -> Back<'_, T> {
            Box::new(move |gradient: Vec<T>, sums: &mut Sums<T>| {
                let by_second = self.constants[0].is_some();
                if !by_second && self.constants[1].is_none() {
                    sums.add(1, self.operation.derivative(true, gradient.clone(), &kept));
                }
                sums.add(0, self.operation.derivative(by_second, gradient, &kept));
            })
        });
        (Arc::new(result), back)
    }
}
