//! Indices of a tensor's numbers after it was turned, cut or repeated.

use super::graph::Graph;
use super::term::{Result, Term, bounded, broadcast};
use crate::layers::Number;
use scaleproof_core::message::message;

/// Indices into a tensor's numbers, row-major.
pub(super) struct View {
    pub shape: Vec<usize>,
    pub at: Vec<usize>,
}

/// Returns the steps from one index along each axis to the next.
fn steps_of(shape: &[usize]) -> Vec<usize> {
    let mut steps = vec![1; shape.len()];
    for i in (1..shape.len()).rev() {
        steps[i - 1] = steps[i] * shape[i];
    }
    steps
}

impl View {
    /// All numbers where they are.
    pub(super) fn of(shape: &[usize]) -> View {
        View {
            shape: shape.to_vec(),
            at: (0..shape.iter().product()).collect(),
        }
    }

    /// Walks so many numbers along each axis, so many steps apart.
    fn walked(self, shape: Vec<usize>, steps: &[usize]) -> View {
        let mut places = vec![0];
        for (side, step) in shape.iter().zip(steps) {
            places = (places.iter().flat_map(|from| (0..*side).map(move |i| from + i * step))).collect();
        }
        let at = places.into_iter().map(|place| self.at[place]).collect();
        View { shape, at }
    }

    /// Reorders the axes, each named once.
    pub(super) fn turned(self, order: &[usize]) -> View {
        let steps = steps_of(&self.shape);
        let shape = order.iter().map(|axis| self.shape[*axis]).collect();
        let steps: Vec<usize> = order.iter().map(|axis| steps[*axis]).collect();
        self.walked(shape, &steps)
    }

    /// Repeated along axes of length 1.
    pub(super) fn expanded(self, shape: &[usize]) -> Result<View> {
        let shape = broadcast(&self.shape, shape)?;
        let mut steps = vec![0; shape.len() - self.shape.len()];
        let sides = self.shape.iter().zip(steps_of(&self.shape));
        steps.extend(sides.map(|(side, step)| if *side == 1 { 0 } else { step }));
        Ok(self.walked(shape, &steps))
    }

    /// Some indices of an axis that is there, in an order of their own.
    pub(super) fn taken(self, axis: usize, indices: &[usize]) -> Result<View> {
        let side = self.shape[axis];
        if indices.is_empty() || indices.iter().any(|p| *p >= side) {
            return Err(message!("it asks for indices {indices:?} of an axis of length {side}"));
        }
        let mut shape = self.shape;
        shape[axis] = indices.len();
        bounded(shape.iter().copied())?;
        let after: usize = shape[axis + 1..].iter().product();
        let blocks = self.at.chunks((side * after).max(1));
        let rows = blocks.flat_map(|block| indices.iter().map(move |p| &block[p * after..][..after]));
        let at = rows.flatten().copied().collect();
        Ok(View { shape, at })
    }

    /// Some indices of an axis, and where there is none an index `beyond` all others.
    pub(super) fn bordered(self, axis: usize, indices: &[Option<i64>], beyond: usize) -> View {
        let mut shape = self.shape;
        let (side, after) = (shape[axis], shape[axis + 1..].iter().product::<usize>());
        shape[axis] = indices.len();
        let mut at = Vec::with_capacity(shape.iter().product());
        for block in self.at.chunks((side * after).max(1)) {
            for index in indices {
                match index {
                    Some(p) => at.extend_from_slice(&block[*p as usize * after..][..after]),
                    None => at.resize(at.len() + after, beyond),
                }
            }
        }
        View { shape, at }
    }
}

impl<T: Number> Graph<T> {
    /// Numbers of a term as a view of its shape has them.
    pub(super) fn viewed(&mut self, term: &Term<T>, view: View) -> Result<Term<T>> {
        if view.at.len() == term.count() && view.at.iter().enumerate().all(|(i, at)| i == *at) {
            return term.shaped(view.shape);
        }
        self.moved(&[term], view.shape, &view.at)
    }

    /// Repeated until a shape is met.
    pub(super) fn expanded(&mut self, term: &Term<T>, shape: &[usize]) -> Result<Term<T>> {
        if term.shape == shape {
            return Ok(term.clone());
        }
        broadcast(&term.shape, shape)?;
        self.viewed(term, View::of(&term.shape).expanded(shape)?)
    }
}
