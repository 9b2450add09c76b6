//! Sums, differences and products, number by number: of two arrays, or of one with a constant.

use std::sync::Arc;

use super::{Array, Back, Layer, Sums, owned, vectorised};

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Operation {
    Sum,
    Product,
}

pub(crate) struct Pairwise {
    pub operation: Operation,
    /// In place of the second array.
    pub constant: Option<Vec<f32>>,
}

impl Operation {
    #[inline(always)]
    fn apply(self, mut a: Vec<f32>, b: &[f32]) -> Vec<f32> {
        vectorised(|| match self {
            Operation::Sum => a.iter_mut().zip(b).for_each(|(a, b)| *a += b),
            Operation::Product => a.iter_mut().zip(b).for_each(|(a, b)| *a *= b),
        });
        a
    }
}

impl Layer for Pairwise {
    fn forward(&self, inputs: Vec<Array>, keeps: bool) -> (Array, Option<Back<'_>>) {
        let (operation, mut inputs) = (self.operation, inputs.into_iter());
        let first = inputs.next().unwrap_or_default();
        let second = inputs.next();
        let has_second = second.is_some();
        // A sum's derivatives are those of its output.
        let factors = (keeps && operation == Operation::Product).then(|| (first.clone(), second.clone()));
        let result = operation.apply(owned(first), self.other(&second));
        let back = move |gradient: Vec<f32>, sums: &mut Sums| match factors {
            None => {
                if has_second {
                    sums.add(1, gradient.clone());
                }
                sums.add(0, gradient);
            }
            Some((first, second)) => {
                if has_second {
                    sums.add(1, operation.apply(gradient.clone(), &first));
                }
                sums.add(0, operation.apply(gradient, self.other(&second)));
            }
        };
        (Arc::new(result), keeps.then(|| Box::new(back) as Back))
    }
}

impl Pairwise {
    /// The numbers of the second array, or the constant's.
    fn other<'a>(&'a self, second: &'a Option<Array>) -> &'a [f32] {
        let constant = self.constant.as_deref();
        second.as_ref().map_or(constant.unwrap_or_default(), |second| second)
    }
}
