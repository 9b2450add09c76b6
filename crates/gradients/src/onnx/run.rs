//! A network as it is run: steps between numbered slots.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::term::{IMAGE, NEVER_COMPUTED, Numbers, Result};
use crate::layers::tape::{Recorded, Slot, Tape, backward, last_uses, taken};
use crate::layers::{Activation, Back, Layer, Moved, Number, Sums};
use scaleproof_core::message::message;

/// Turns computed indices into places in a tensor.
pub(super) type Places = dyn Fn(&[i64]) -> Result<Vec<usize>> + Send + Sync;
pub(super) type ToWhole<T> = dyn Fn(&[Numbers<T>]) -> Result<Vec<i64>> + Send + Sync;

#[derive(Clone)]
pub(super) enum Work<T> {
    Layer(Arc<dyn Layer<T>>),
    Sigmoid,
    Moved(Arc<Moved>),
    /// Numbers of the first input at places that the second one, of whole numbers, points to.
    Picked(Arc<Places>),
    /// Whole numbers that say in which order the input's numbers follow each other along an axis.
    Order(Arc<ToWhole<T>>),
    Whole(Arc<ToWhole<T>>),
    /// Whole numbers as fractions.
    Fractions,
}

/// The numbers of the output, and the backward pass where a gradient passes.
type Computed<'a, T> = (Numbers<T>, Option<Back<'a, T>>);

impl<T: Number> Work<T> {
    pub(super) fn run(&self, inputs: Vec<Numbers<T>>, keeps: bool) -> Result<Computed<'_, T>> {
        let layer: &dyn Layer<T> = match self {
            Work::Layer(layer) => layer.as_ref(),
            Work::Sigmoid => &Activation::Sigmoid,
            Work::Moved(moved) => match inputs.first() {
                Some(Numbers::Whole(_)) => {
                    let inputs = inputs.iter().map(Numbers::whole).collect::<Result<Vec<_>>>()?;
                    return Ok((Numbers::Whole(Arc::new(moved.of(&inputs))), None));
                }
                _ => moved.as_ref(),
            },
            Work::Picked(places) => return picked(inputs, places.as_ref(), keeps),
            Work::Order(work) | Work::Whole(work) => return Ok((Numbers::Whole(Arc::new(work(&inputs)?)), None)),
            Work::Fractions => {
                let whole = inputs.first().ok_or(NEVER_COMPUTED)?.whole()?;
                let floats = whole.iter().map(|v| T::of(*v as f64)).collect();
                return Ok((Numbers::Floats(Arc::new(floats)), None));
            }
        };
        let inputs = inputs.into_iter().map(Numbers::floats).collect::<Result<_>>()?;
        let (output, back) = layer.forward(inputs, keeps);
        Ok((Numbers::Floats(output), back))
    }
}

fn picked<'a, T: Number>(inputs: Vec<Numbers<T>>, places: &Places, keeps: bool) -> Result<Computed<'a, T>> {
    let [numbers, indices] = <[_; 2]>::try_from(inputs).map_err(|_| NEVER_COMPUTED)?;
    let places = places(indices.whole()?)?;
    Ok(match numbers {
        Numbers::Whole(v) => (Numbers::Whole(Arc::new(places.iter().map(|at| v[*at]).collect())), None),
        Numbers::Floats(v) => {
            let (found, count) = (places.iter().map(|at| v[*at]).collect(), v.len());
            let back = move |gradient: Vec<T>, sums: &mut Sums<T>| {
                let sum = sums.sum_mut(0, count);
                places.iter().zip(gradient).for_each(|(at, g)| sum[*at] += g);
            };
            (
                Numbers::Floats(Arc::new(found)),
                keeps.then(|| Box::new(back) as Back<T>),
            )
        }
    })
}

pub(super) struct Step<T> {
    /// For messages: the node's name in the file.
    pub node: Arc<str>,
    pub work: Work<T>,
    pub inputs: Vec<Slot>,
    pub output: Slot,
    /// True where a gradient passes.
    pub is_followed: bool,
}

/// Numbers of the slots that are asked for, and the tape.
type RunState<'a, T> = (Vec<Option<Numbers<T>>>, Tape<'a, T>);

pub(super) struct Plan<T> {
    steps: Vec<Step<T>>,
    /// For each step, the slots that no later step and no output reads.
    last_uses: Vec<BTreeSet<Slot>>,
    constants: Vec<(Slot, Numbers<T>)>,
    slots: usize,
}

impl<T: Number> Plan<T> {
    /// Keeps those of some steps, in their order, that an output follows from. `read`: the slots of the outputs.
    pub(super) fn new(
        mut steps: Vec<Step<T>>,
        mut constants: Vec<(Slot, Numbers<T>)>,
        slots: usize,
        read: impl IntoIterator<Item = Slot>,
    ) -> Plan<T> {
        let outputs = BTreeSet::from_iter(read);
        let mut needed = outputs.clone();
        steps.reverse();
        steps.retain(|step| {
            let is_needed = needed.contains(&step.output);
            if is_needed {
                needed.extend(&step.inputs);
            }
            is_needed
        });
        steps.reverse();
        constants.retain(|(slot, _)| needed.contains(slot));
        let last_uses = last_uses(steps.iter().map(|step| &step.inputs[..]), outputs);
        Plan {
            steps,
            last_uses,
            constants,
            slots,
        }
    }

    /// For an image; the tape is empty unless it `keeps` the backward passes.
    pub(super) fn run(&self, image: Vec<T>, keeps: bool) -> Result<RunState<'_, T>> {
        let mut values: Vec<Option<Numbers<T>>> = vec![None; self.slots];
        for (slot, constant) in &self.constants {
            values[*slot] = Some(constant.clone());
        }
        values[IMAGE] = Some(Numbers::Floats(Arc::new(image)));
        let mut tape = Vec::new();
        for (step, last_uses) in self.steps.iter().zip(&self.last_uses) {
            let inputs = step.inputs.iter();
            let inputs = inputs.map(|slot| taken(&mut values, *slot, last_uses).ok_or(NEVER_COMPUTED.into()));
            let inputs = inputs.collect::<Result<_>>()?;
            let (output, back) = step
                .work
                .run(inputs, keeps && step.is_followed)
                .map_err(|fault| message!("at {}: {fault}", step.node))?;
            values[step.output] = Some(output);
            let (output, slots) = (step.output, &step.inputs[..]);
            tape.extend(back.map(|back| Recorded { output, slots, back }));
        }
        Ok((values, tape))
    }

    /// Returns the derivative by the image from those by some slots; `None` where nothing comes back.
    pub(super) fn back(&self, tape: Tape<T>, derivatives: impl Iterator<Item = (Slot, Vec<T>)>) -> Option<Vec<T>> {
        backward(tape, self.slots, derivatives)[IMAGE].take()
    }
}
