//! What a network is run in: a layer on plain arrays, or steps that the framework runs between numbers that are plain arrays.

use std::collections::{BTreeMap, BTreeSet};

use burn::tensor::{Device, Tensor, TensorData};

use super::graph::{Graph, GraphStep, Slot, last_uses};
use super::value::{Floats, Held, NEVER_COMPUTED, Result, Value};
use crate::NetworkFault;
use crate::layers::{Layer, Sums, owned};

/// The derivative by the numbers of each slot, as far as it is summed up.
pub(super) type Gradients = [Option<Vec<f32>>];

/// The backward pass of one part: adds to the derivatives by its inputs what those by its outputs are worth there.
pub(super) type Back<'a> = Box<dyn FnOnce(&mut Gradients) -> Result<()> + 'a>;

/// What the outputs hold, and the backward pass from them.
type Answer<'a> = (Vec<(Slot, Held)>, Option<Back<'a>>);

pub(super) enum Part {
    Layer(LayerPart),
    Framework(Segment),
}

impl Part {
    pub(super) fn inputs(&self) -> Vec<Slot> {
        match self {
            Part::Layer(part) => part.inputs.clone(),
            Part::Framework(segment) => segment.inputs.keys().copied().collect(),
        }
    }

    /// Runs forward, and with `keeps` keeps what the backward pass needs. `taken`: what a slot holds.
    pub(super) fn run(&self, taken: impl FnMut(Slot) -> Option<Held>, keeps: bool) -> Result<Answer<'_>> {
        match self {
            Part::Layer(part) => part.run(taken, keeps),
            Part::Framework(segment) => segment.run(taken, keeps),
        }
    }
}

/// The derivative by a slot, unless it is zero everywhere: zeros come back as zeros, at the same cost.
fn taken_gradient(gradients: &mut Gradients, slot: Slot) -> Option<Vec<f32>> {
    gradients[slot].take().filter(|g| g.iter().any(|g| *g != 0.0))
}

/// One layer between its slots.
pub(super) struct LayerPart {
    pub layer: Box<dyn Layer>,
    pub inputs: Vec<Slot>,
    pub output: Slot,
    pub shape: Vec<usize>,
}

impl LayerPart {
    fn run(&self, mut taken: impl FnMut(Slot) -> Option<Held>, keeps: bool) -> Result<Answer<'_>> {
        let inputs = self.inputs.iter().map(|slot| match taken(*slot) {
            Some(Held::Floats { numbers, .. }) => Ok(numbers),
            _ => Err(NEVER_COMPUTED.into()),
        });
        let (numbers, back) = self.layer.forward(inputs.collect::<Result<_>>()?, keeps);
        let back = back.map(|back| -> Back<'_> {
            Box::new(move |all: &mut Gradients| {
                if let Some(gradient) = taken_gradient(all, self.output) {
                    let slots = &self.inputs;
                    back(gradient, &mut Sums { all, slots });
                }
                Ok(())
            })
        });
        let shape = self.shape.clone();
        Ok((vec![(self.output, Held::Floats { shape, numbers })], back))
    }
}

/// Steps that the framework runs.
pub(super) struct Segment {
    device: Device,
    steps: Vec<GraphStep>,
    /// For each step, the slots that no later one and no output reads.
    last_uses: Vec<BTreeSet<Slot>>,
    constants: BTreeMap<Slot, Value>,
    /// Whether the derivative by an input is computed.
    inputs: BTreeMap<Slot, bool>,
    outputs: Vec<Slot>,
}

impl Segment {
    /// Some steps of a graph, in their order. `values`: of [`Graph::run_all`].
    pub(super) fn new(graph: &Graph, steps: Vec<GraphStep>, values: &[Option<Value>]) -> Segment {
        let slots_of = |step: &GraphStep| step.inputs.iter().flatten().copied().collect::<Vec<Slot>>();
        let read: Vec<Vec<Slot>> = steps.iter().map(slots_of).collect();
        let made: BTreeSet<Slot> = steps.iter().flat_map(|step| step.outputs.iter().copied()).collect();
        let is_other = |step: &&GraphStep| !step.outputs.iter().any(|slot| made.contains(slot));
        let mut needed: BTreeSet<Slot> = graph.steps.iter().filter(is_other).flat_map(slots_of).collect();
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

    fn run(&self, mut taken: impl FnMut(Slot) -> Option<Held>, keeps: bool) -> Result<Answer<'_>> {
        let (mut values, mut leaves) = (self.constants.clone(), Vec::new());
        for (slot, requires_grad) in &self.inputs {
            let value = match taken(*slot).ok_or(NEVER_COMPUTED)? {
                Held::Whole(numbers) => Value::Integers(numbers),
                Held::Floats { shape, numbers } => {
                    let mut v = Floats::new(owned(numbers), &shape, &self.device)?;
                    if keeps && *requires_grad {
                        v.x = v.x.require_grad();
                        leaves.push((*slot, v.x.clone()));
                    }
                    Value::Floats(v)
                }
            };
            values.insert(*slot, value);
        }
        for (step, last_uses) in self.steps.iter().zip(&self.last_uses) {
            let mut read = |slot: Slot| {
                if last_uses.contains(&slot) {
                    values.remove(&slot)
                } else {
                    values.get(&slot).cloned()
                }
            };
            let inputs = step.inputs.iter().map(|slot| read((*slot)?)).collect();
            values.extend(step.run(inputs, &self.device)?);
        }
        let (mut held, mut tracked) = (Vec::new(), Vec::new());
        for slot in &self.outputs {
            let value = values.remove(slot).ok_or(NEVER_COMPUTED)?;
            held.push((*slot, Held::from_value(&value)?));
            match value {
                Value::Floats(v) if v.x.is_tracked() => tracked.push((*slot, v.x)),
                _ => {}
            }
        }
        let back: Option<Back<'_>> = (!tracked.is_empty()).then(|| {
            Box::new(move |gradients: &mut Gradients| -> Result<()> {
                let parts = tracked.into_iter().filter_map(|(slot, x)| {
                    let gradient = TensorData::new(taken_gradient(gradients, slot)?, x.dims());
                    Some((x * Tensor::from_data(gradient, &self.device)).sum())
                });
                let Some(loss) = parts.reduce(|sum, part| sum + part) else {
                    return Ok(());
                };
                let by_leaf = loss.backward();
                for (slot, leaf) in leaves {
                    if let Some(gradient) = leaf.grad(&by_leaf) {
                        let numbers = gradient.try_into_vec_as::<f32>().map_err(NetworkFault::framework)?;
                        let (all, slots) = (&mut *gradients, &[slot]);
                        Sums { all, slots }.add(0, numbers);
                    }
                }
                Ok(())
            }) as Back<'_>
        });
        Ok((held, back))
    }
}
