//! A network while it is read: operators add steps to it, and what follows from constants alone is computed at once.

use std::sync::Arc;

use super::run::{Places, Step, ToWhole, Work};
use super::term::{Kind, Numbers, Result, Term, Value, bounded, too_large};
use crate::layers::tape::Slot;
use crate::layers::{Layer, Moved, Number};

/// All numbers of all tensors of one image; those of the largest detectors are a tenth of this.
const MOST_KEPT: usize = 1 << 30;

pub(super) struct Graph<T> {
    pub steps: Vec<Step<T>>,
    /// Those that steps read.
    pub constants: Vec<(Slot, Numbers<T>)>,
    /// Count of numbers in each slot.
    pub counts: Vec<usize>,
    /// The node that is being read.
    pub node: Arc<str>,
    kept: usize,
}

impl<T: Number> Graph<T> {
    /// Creates one with the image's slot alone.
    pub(super) fn new(image: usize) -> Graph<T> {
        Graph {
            steps: Vec::new(),
            constants: Vec::new(),
            counts: vec![image],
            node: "".into(),
            kept: image,
        }
    }

    pub(super) fn layer(
        &mut self,
        layer: impl Layer<T> + 'static,
        inputs: &[&Term<T>],
        shape: Vec<usize>,
    ) -> Result<Term<T>> {
        self.work(Work::Layer(Arc::new(layer)), inputs, shape)
    }

    /// For each number of the result, which of all inputs' numbers it is, these counted on from input to input.
    pub(super) fn moved(&mut self, inputs: &[&Term<T>], shape: Vec<usize>, at: &[usize]) -> Result<Term<T>> {
        let counts = inputs.iter().map(|input| input.count()).collect();
        self.work(Work::Moved(Arc::new(Moved::new(counts, at))), inputs, shape)
    }

    /// Numbers of a term at places that indices point to.
    pub(super) fn picked(
        &mut self,
        [term, indices]: [&Term<T>; 2],
        shape: Vec<usize>,
        places: impl Fn(&[i64]) -> Result<Vec<usize>> + Send + Sync + 'static,
    ) -> Result<Term<T>> {
        let places: Arc<Places> = Arc::new(places);
        self.work(Work::Picked(places), &[term, indices], shape)
    }

    pub(super) fn whole(
        &mut self,
        inputs: &[&Term<T>],
        shape: Vec<usize>,
        work: impl Fn(&[Numbers<T>]) -> Result<Vec<i64>> + Send + Sync + 'static,
    ) -> Result<Term<T>> {
        let work: Arc<ToWhole<T>> = Arc::new(work);
        self.work(Work::Whole(work), inputs, shape)
    }

    /// Adds some work on terms, whose result is a constant or a new slot.
    pub(super) fn work(&mut self, work: Work<T>, inputs: &[&Term<T>], shape: Vec<usize>) -> Result<Term<T>> {
        let count = bounded(shape.iter().copied())?;
        let has_all = count > 0 && inputs.iter().all(|input| input.count() > 0);
        if !has_all && !matches!(work, Work::Moved(_) | Work::Whole(_)) {
            return Err("it has to do with a tensor without numbers".into());
        }
        self.keep(count)?;
        let constants: Option<Vec<Numbers<T>>> = inputs.iter().map(|input| input.constant().cloned()).collect();
        let value = match constants {
            Some(constants) => Value::Constant(work.run(constants, false)?.0),
            None => self.step(work, inputs, count),
        };
        Ok(Term { shape, value })
    }

    fn keep(&mut self, count: usize) -> Result<()> {
        self.kept += count;
        let fits = self.kept <= MOST_KEPT;
        fits.then_some(()).ok_or_else(|| too_large(MOST_KEPT))
    }

    /// A constant that was made, its numbers counted with all others.
    pub(super) fn kept(&mut self, constant: Term<T>) -> Result<Term<T>> {
        self.keep(bounded(constant.shape.iter().copied())?)?;
        Ok(constant)
    }

    fn step(&mut self, work: Work<T>, inputs: &[&Term<T>], count: usize) -> Value<T> {
        let is_followed = inputs.iter().any(|input| input.kind() == Kind::Followed);
        let is_whole = inputs.first().is_some_and(|input| input.is_whole());
        let kind = match work {
            Work::Order(_) | Work::Whole(_) => Kind::Whole,
            Work::Moved(_) | Work::Picked(_) if is_whole => Kind::Whole,
            _ if is_followed => Kind::Followed,
            _ => Kind::Free,
        };
        let inputs = inputs.iter().map(|input| self.slot_of(input)).collect();
        let output = self.new_slot(count);
        self.steps.push(Step {
            node: self.node.clone(),
            work,
            inputs,
            output,
            is_followed: kind == Kind::Followed,
        });
        Value::Image(output, kind)
    }

    fn slot_of(&mut self, term: &Term<T>) -> Slot {
        match &term.value {
            Value::Image(slot, _) => *slot,
            Value::Constant(numbers) => {
                let slot = self.new_slot(numbers.count());
                self.constants.push((slot, numbers.clone()));
                slot
            }
        }
    }

    pub(super) fn new_slot(&mut self, count: usize) -> Slot {
        self.counts.push(count);
        self.counts.len() - 1
    }

    /// The step that a term comes from.
    pub(super) fn maker(&self, term: &Term<T>) -> Option<&Step<T>> {
        let slot = term.slot()?;
        self.steps.iter().rev().find(|step| step.output == slot)
    }
}
