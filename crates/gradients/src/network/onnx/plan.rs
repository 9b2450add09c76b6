//! A network as it is run: layers on plain arrays where there is one for a step, the framework's tensors for all else.
//!
//! On a processor the layers take a small part of the framework's time, whose autodiff graph keeps and computes more than the backward pass to
//! the image needs. On other devices, and in 64 bits, everything is the framework's.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use burn::tensor::{Device, FloatDType};

use super::graph::{Graph, GraphStep, Slot, last_uses};
use super::operator::Argument;
use super::part::{Back, LayerPart, Part, Segment};
use super::value::{Held, NEVER_COMPUTED, Result, Value};
use crate::NetworkFault;
use crate::layers::{Activation, Layer, Sums};

pub(super) struct Plan {
    parts: Vec<Part>,
    /// For each part, the slots that no later part or output reads.
    last_uses: Vec<BTreeSet<Slot>>,
    input: (Slot, Vec<usize>),
    outputs: Vec<Slot>,
    /// Outputs that are the same for every image.
    constants: BTreeMap<Slot, Held>,
    slots: usize,
}

impl Plan {
    /// `values`: of [`Graph::run_all`].
    pub(super) fn new(graph: &Graph, values: &[Option<Value>]) -> Result<Plan> {
        let constants = graph.constants.keys().copied();
        let mut steps = Steps {
            graph,
            values,
            left: graph.steps.iter().collect(),
            ready: constants.chain([graph.input]).collect(),
            has_layers: has_layers(&graph.device),
        };
        let mut parts = Vec::new();
        while !steps.left.is_empty() {
            let before = steps.left.len();
            while let Some(found) = steps.next_layers() {
                parts.extend(found.into_iter().map(Part::Layer));
            }
            let others = steps.next_others();
            if !others.is_empty() {
                parts.push(Part::Framework(Segment::new(graph, others, values)));
            }
            if steps.left.len() == before {
                return Err("the graph has a cycle".into());
            }
        }
        let outputs: Vec<Slot> = graph.outputs.iter().map(|(_, slot)| *slot).collect();
        let constants = outputs
            .iter()
            .filter_map(|slot| Some((*slot, graph.constants.get(slot)?)));
        let constants = constants.map(|(slot, value)| Ok((slot, Held::from_value(value)?)));
        let inputs: Vec<Vec<Slot>> = parts.iter().map(Part::inputs).collect();
        let shape = values[graph.input].as_ref().map(Value::shape).unwrap_or_default();
        Ok(Plan {
            last_uses: last_uses(&inputs, outputs.iter().copied()),
            parts,
            input: (graph.input, shape),
            constants: constants.collect::<Result<_>>()?,
            outputs,
            slots: graph.slots,
        })
    }

    /// The outputs for an image, and where `keeps` the backward passes of the parts, in the order they were run.
    pub(super) fn run(&self, image: Vec<f32>, keeps: bool) -> Result<(Vec<Held>, Vec<Back<'_>>)> {
        let mut held: Vec<Option<Held>> = vec![None; self.slots];
        for (slot, constant) in &self.constants {
            held[*slot] = Some(constant.clone());
        }
        let (shape, numbers) = (self.input.1.clone(), Arc::new(image));
        held[self.input.0] = Some(Held::Floats { shape, numbers });
        let mut tape = Vec::new();
        for (part, last_uses) in self.parts.iter().zip(&self.last_uses) {
            let taken = |slot: Slot| {
                if last_uses.contains(&slot) {
                    held[slot].take()
                } else {
                    held[slot].clone()
                }
            };
            let (outputs, back) = part.run(taken, keeps)?;
            outputs.into_iter().for_each(|(slot, value)| held[slot] = Some(value));
            tape.extend(back);
        }
        let output = |slot: &Slot| held[*slot].clone().ok_or(NetworkFault::Malformed(NEVER_COMPUTED));
        Ok((self.outputs.iter().map(output).collect::<Result<_>>()?, tape))
    }

    /// From the derivatives by the outputs to that by the image; `None` where nothing comes back.
    pub(super) fn back(&self, tape: Vec<Back>, derivatives: Vec<Vec<f32>>) -> Result<Option<Vec<f32>>> {
        let mut sums: Vec<Option<Vec<f32>>> = vec![None; self.slots];
        for (i, derivative) in derivatives.into_iter().enumerate() {
            let (all, slots) = (&mut sums, &self.outputs);
            Sums { all, slots }.add(i, derivative);
        }
        for back in tape.into_iter().rev() {
            back(&mut sums)?;
        }
        Ok(sums[self.input.0].take())
    }
}

/// The steps that are no part of a plan yet.
struct Steps<'a> {
    graph: &'a Graph,
    values: &'a [Option<Value>],
    left: Vec<&'a GraphStep>,
    ready: BTreeSet<Slot>,
    has_layers: bool,
}

impl Steps<'_> {
    fn is_ready(&self, step: &GraphStep) -> bool {
        step.inputs.iter().flatten().all(|slot| self.ready.contains(slot))
    }

    /// Those of the first step whose inputs are there and for which there are layers, one an output.
    fn next_layers(&mut self) -> Option<Vec<LayerPart>> {
        let mut ready = self.left.iter().filter(|step| self.is_ready(step));
        let parts = ready.find_map(|step| self.layers(step))?;
        self.ready.extend(parts.iter().map(|part| part.output));
        // A sigmoid that is part of another layer has an output that nobody reads any more.
        let is_done = |step: &&GraphStep| step.outputs.iter().all(|slot| self.ready.contains(slot));
        let fused = |step: &&GraphStep| self.silu(step).is_some_and(|part| self.ready.contains(&part.output));
        let left = self.left.iter().filter(|step| !is_done(step) && !fused(step));
        self.left = left.copied().collect();
        Some(parts)
    }

    /// All steps without a layer that wait for no step with one.
    fn next_others(&mut self) -> Vec<GraphStep> {
        let mut others = Vec::new();
        for step in std::mem::take(&mut self.left) {
            if self.is_ready(step) && self.layers(step).is_none() {
                self.ready.extend(&step.outputs);
                others.push(step.clone());
            } else {
                self.left.push(step)
            }
        }
        others
    }

    fn layers(&self, step: &GraphStep) -> Option<Vec<LayerPart>> {
        if !self.has_layers {
            return None;
        }
        if let Some(silu) = self.silu(step) {
            return Some(vec![silu]);
        }
        let shape = |slot: &Slot| match &self.values[*slot] {
            Some(Value::Floats(v)) => Some(v.shape()),
            _ => None,
        };
        let constants = &self.graph.constants;
        let argument = |slot: &Option<Slot>| match slot {
            None => Some(Argument::Absent),
            Some(slot) => match constants.get(slot) {
                Some(value) => Some(Argument::Constant(value.clone())),
                None => shape(slot).map(Argument::Image),
            },
        };
        let arguments: Vec<Argument> = step.inputs.iter().map(argument).collect::<Option<_>>()?;
        let shapes: Vec<Vec<usize>> = step.outputs.iter().map(shape).collect::<Option<_>>()?;
        let inputs = step.inputs.iter().flatten().copied();
        let inputs: Vec<Slot> = inputs.filter(|slot| !constants.contains_key(slot)).collect();
        let layers = step.operator.layers(&arguments, &shapes, &self.graph.device)?;
        let parts = layers.into_iter().zip(shapes).zip(&step.outputs);
        let part = |((layer, shape), output): ((Box<dyn Layer>, Vec<usize>), &Slot)| LayerPart {
            layer,
            inputs: inputs.clone(),
            output: *output,
            shape,
        };
        Some(parts.map(part).collect())
    }

    /// A sigmoid that only its own input is multiplied with.
    fn silu(&self, sigmoid: &GraphStep) -> Option<LayerPart> {
        let ([Some(x)], [s]) = (&sigmoid.inputs[..], &sigmoid.outputs[..]) else {
            return None;
        };
        let is_output = self.graph.outputs.iter().any(|(_, slot)| slot == s);
        if !sigmoid.operator.is_sigmoid || is_output {
            return None;
        }
        let mut readers = self.graph.steps.iter().filter(|step| step.inputs.contains(&Some(*s)));
        let (product, None) = (readers.next()?, readers.next()) else {
            return None;
        };
        let is_of_both = matches!(&product.inputs[..], [Some(a), Some(b)] if [a, b] == [x, s] || [a, b] == [s, x]);
        match product.outputs[..] {
            [output] if product.operator.is_product && is_of_both => Some(LayerPart {
                layer: Box::new(Activation::Silu),
                inputs: vec![*x],
                output,
                shape: self.values[*x].as_ref().map(Value::shape)?,
            }),
            _ => None,
        }
    }
}

/// Whether plain arrays are what this device computes with.
fn has_layers(device: &Device) -> bool {
    device.clone().without_autodiff() == Device::flex() && device.settings().float_dtype == FloatDType::F32
}
