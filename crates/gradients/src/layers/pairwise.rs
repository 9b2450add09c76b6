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
        let mut inputs = inputs.into_iter();
        let first = inputs.next().unwrap_or_default();
        let second = inputs.next();
        let operation = self.operation;
        let other = |second: &Option<Array>| {
            second
                .clone()
                .or_else(|| self.constant.clone().map(Arc::new))
                .unwrap_or_default()
        };
        let factors = (keeps && operation == Operation::Product).then(|| (first.clone(), second.clone()));
        let result = match (&second, &self.constant) {
            (None, Some(constant)) => operation.apply(owned(first), constant),
            _ => operation.apply(owned(first), &other(&second)),
        };
        let has_second = second.is_some();
        let back = move |gradient: Vec<f32>, sums: &mut Sums| {
            let Some((first, second)) = factors else {
                if has_second {
                    sums.add(1, gradient.clone());
                }
                return sums.add(0, gradient);
            };
            match (second, &self.constant) {
                (Some(second), _) => {
                    sums.add(1, operation.apply(gradient.clone(), &first));
                    sums.add(0, operation.apply(gradient, &second));
                }
                (None, constant) => {
                    let constant = constant.as_deref().unwrap_or_default();
                    sums.add(0, operation.apply(gradient, constant));
                }
            }
        };
        (Arc::new(result), keeps.then(|| Box::new(back) as Back))
    }
}
