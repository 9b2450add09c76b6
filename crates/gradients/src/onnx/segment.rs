//! Steps of a network that the framework runs, between numbers that are plain arrays.

use std::collections::{BTreeMap, BTreeSet};

use burn::tensor::{Device, Tensor, TensorData};

use super::graph::{Graph, GraphStep, Slot, last_uses};
use super::operator::Inputs;
use super::value::{Floats, Held, RANK, Result, Value};
use crate::NetworkFault;
use crate::layers::{Sums, owned};

pub(super) struct Segment {
    device: Device,
    steps: Vec<GraphStep>,
    /// For each step, the slots that no later one and no output reads.
    last_uses: Vec<BTreeSet<Slot>>,
    constants: BTreeMap<Slot, Value>,
    /// Whether a derivative by an input is wanted.
    inputs: BTreeMap<Slot, bool>,
    outputs: Vec<Slot>,
}

/// What the outputs hold, and the backward pass from them.
type Answer<'a> = (Vec<(Slot, Held)>, Option<Way<'a>>);

/// The autodiff graph of one segment.
pub(super) struct Way<'a> {
    device: &'a Device,
    inputs: Vec<(Slot, Tensor<RANK>)>,
    outputs: Vec<(Slot, Tensor<RANK>)>,
}

impl Segment {
    /// Some steps of a graph, in their order. `values`: of [`Graph::run_all`].
    pub(super) fn new(graph: &Graph, steps: Vec<GraphStep>, values: &[Option<Value>]) -> Segment {
        let slots_of = |step: &GraphStep| step.inputs.iter().flatten().copied().collect::<Vec<Slot>>();
        let read: Vec<Vec<Slot>> = steps.iter().map(slots_of).collect();
        let made: BTreeSet<Slot> = steps.iter().flat_map(|step| step.outputs.iter().copied()).collect();
        let others = graph
            .steps
            .iter()
            .filter(|step| !step.outputs.iter().any(|slot| made.contains(slot)));
        let mut needed: BTreeSet<Slot> = others.flat_map(slots_of).collect();
        needed.extend(graph.outputs.iter().map(|(_, slot)| *slot));
        let (mut constants, mut inputs) = (BTreeMap::new(), BTreeMap::new());
        for slot in read.iter().flatten().filter(|slot| !made.contains(slot)) {
            match graph.constants.get(slot) {
                Some(constant) => _ = constants.insert(*slot, constant.clone()),
                None => _ = inputs.insert(*slot, values[*slot].as_ref().is_some_and(Value::requires_grad)),
            }
        }
        Segment {
            device: graph.device.clone(),
            last_uses: last_uses(&read, needed.iter().copied()),
            steps,
            constants,
            inputs,
            outputs: made.intersection(&needed).copied().collect(),
        }
    }

    pub(super) fn inputs(&self) -> Vec<Slot> {
        self.inputs.keys().copied().collect()
    }

    /// `taken`: what a slot holds.
    pub(super) fn run(&self, mut taken: impl FnMut(Slot) -> Option<Held>, keeps: bool) -> Result<Answer<'_>> {
        let (mut values, mut inputs) = (self.constants.clone(), Vec::new());
        for (slot, requires_grad) in &self.inputs {
            let value = match taken(*slot).ok_or("a value is never computed")? {
                Held::Whole(numbers) => Value::Integers(numbers),
                Held::Floats { shape, numbers } => {
                    let Floats { mut x, rank } = Floats::new(owned(numbers), &shape, &self.device)?;
                    if keeps && *requires_grad {
                        x = x.require_grad();
                        inputs.push((*slot, x.clone()));
                    }
                    Value::Floats(Floats { x, rank })
                }
            };
            values.insert(*slot, value);
        }
        for (step, last_uses) in self.steps.iter().zip(&self.last_uses) {
            let read = step.inputs.iter().map(|slot| {
                if last_uses.contains(&(*slot)?) {
                    values.remove(&(*slot)?)
                } else {
                    values.get(&(*slot)?).cloned()
                }
            });
            let values_read = read.collect();
            let device = &self.device;
            values.extend(step.run(Inputs {
                values: values_read,
                device,
            })?);
        }
        let (mut held, mut outputs) = (Vec::new(), Vec::new());
        for slot in &self.outputs {
            let value = values.remove(slot).ok_or("a value is never computed")?;
            held.push((*slot, Held::of(&value)?));
            match value {
                Value::Floats(v) if v.x.is_tracked() => outputs.push((*slot, v.x)),
                _ => {}
            }
        }
        let device = &self.device;
        let way = (!outputs.is_empty()).then_some(Way {
            device,
            inputs,
            outputs,
        });
        Ok((held, way))
    }
}

impl Way<'_> {
    /// Adds to the inputs' sums what the outputs' sums are worth there.
    pub(super) fn back(self, sums: &mut [Option<Vec<f32>>]) -> Result<()> {
        let mut loss: Option<Tensor<1>> = None;
        for (slot, tensor) in self.outputs {
            let Some(gradient) = sums[slot].take().filter(|g| g.iter().any(|g| *g != 0.0)) else {
                continue;
            };
            let gradient = Tensor::from_data(TensorData::new(gradient, tensor.dims()), self.device);
            let part = (tensor * gradient).sum();
            loss = Some(match loss {
                Some(sum) => sum + part,
                None => part,
            });
        }
        let Some(gradients) = loss.map(|loss| loss.backward()) else {
            return Ok(());
        };
        for (slot, leaf) in self.inputs {
            if let Some(gradient) = leaf.grad(&gradients) {
                let numbers = gradient.try_into_vec_as::<f32>();
                let numbers = numbers.map_err(|e| NetworkFault::Framework(e.to_string()))?;
                let slots = &[slot];
                Sums { all: sums, slots }.add(0, numbers);
            }
        }
        Ok(())
    }
}
