//! The numbers before a network's last sigmoids.
//!
//! A confidence near 1 has no fractions left in 32 bits: from a logit of 17 on, σ is 1, `−ln(1 − C)` infinite and its gradient 0 · ∞. Where
//! outputs are sigmoids that were only moved about afterwards, the network is therefore run up to their logits instead, and σ is left to
//! the reader of the outputs, in 64 bits.

use std::collections::{BTreeMap, BTreeSet};

use burn::tensor::Device;

use super::graph::{Graph, GraphStep, Slot};
use super::operator::Rearranged;
use super::value::{Floats, NEVER_COMPUTED, Result, Value};

/// Leads the outputs past the last sigmoids. Answers, for each output, which of its numbers are logits now. `values`: of
/// [`Graph::run_all`].
pub(super) fn expose_logits(graph: &mut Graph, values: &[Option<Value>]) -> Result<Vec<Vec<bool>>> {
    let asked = moved_to_outputs(graph);
    let mut twins = Twins {
        known: BTreeMap::new(),
        values: values.to_vec(),
        device: graph.device.clone(),
    };
    let mut at = 0;
    // In the order of the steps: each finds the twins of what it moves, and what reads a list's new order is looked at after it.
    while let Some(step) = graph.steps.get(at).cloned() {
        at += 1;
        let asked_of = match step.operator.rearranged {
            Rearranged::Ordered => 1, // the indices alone say nothing of the scores
            _ => step.outputs.len(),
        };
        if !step.outputs.iter().take(asked_of).any(|slot| asked.contains(slot)) {
            continue;
        }
        if step.operator.is_sigmoid {
            let logits = step.inputs.first().copied().flatten().ok_or("a sigmoid has no input")?;
            let is_logit = twins.filled(step.outputs[0], 1.0)?;
            twins.known.insert(step.outputs[0], (logits, is_logit));
        } else if let Some(twin) = twins.moved(graph, &step)? {
            graph.steps.insert(at, twin);
            at += 1;
        }
    }
    let mut masks = Vec::new();
    for (_, slot) in &mut graph.outputs {
        let twin = twins.known.get(slot);
        masks.push(match twin {
            Some((_, Value::Floats(mask))) => mask.values()?.iter().map(|v| *v > 0.5).collect(),
            _ => Vec::new(),
        });
        *slot = twin.map_or(*slot, |(logits, _)| *logits);
    }
    Ok(masks)
}

fn moved_to_outputs(graph: &Graph) -> BTreeSet<Slot> {
    let mut asked: BTreeSet<Slot> = graph.outputs.iter().map(|(_, slot)| *slot).collect();
    for step in graph.steps.iter().rev() {
        if step.outputs.iter().any(|slot| asked.contains(slot)) {
            let moved = step.operator.moved_inputs(step.inputs.len());
            asked.extend(step.inputs.iter().take(moved).flatten());
        }
    }
    asked
}

/// Values with the logits in place of their sigmoids.
struct Twins {
    /// For a slot that holds sigmoids, the slot of its twin, and a mask: 1 where that holds a logit, 0 elsewhere.
    known: BTreeMap<Slot, (Slot, Value)>,
    /// What each slot holds; for that of a twin, what it is the twin of.
    values: Vec<Option<Value>>,
    device: Device,
}

impl Twins {
    /// Repeats a step that only moves numbers, on the twins of what it moves. `None` when none of it holds a logit, or when a sort would mix logits
    /// with scores.
    fn moved(&mut self, graph: &mut Graph, step: &GraphStep) -> Result<Option<GraphStep>> {
        let moved = step.operator.moved_inputs(step.inputs.len());
        let (mut inputs, mut masks, mut has_logits) = (step.inputs.clone(), Vec::new(), false);
        for (i, input) in step.inputs.iter().enumerate() {
            masks.push(match input {
                Some(slot) if i < moved => Some(match self.known.get(slot) {
                    Some((twin, mask)) => {
                        has_logits = true;
                        inputs[i] = Some(*twin);
                        mask.clone()
                    }
                    None => self.filled(*slot, 0.0)?,
                }),
                Some(slot) => self.values[*slot].clone(),
                None => None,
            });
        }
        // Logits and scores have one order, a mixture of them has none.
        let is_ordered = step.operator.rearranged == Rearranged::Ordered;
        if !has_logits || (is_ordered && !holds_only_logits(&masks[0])?) {
            return Ok(None);
        }
        let outputs: Vec<Slot> = step.outputs.iter().map(|_| graph.new_slot()).collect();
        let same = step.outputs.iter().map(|slot| self.values[*slot].clone());
        self.values.extend(same.collect::<Vec<_>>());
        for ((slot, mask), twin) in step.run(masks, &self.device)?.zip(&outputs) {
            if is_ordered && slot != step.outputs[0] {
                // Scores that round to the same number are ordered by their logits alone: the indices have to be of that order, too.
                graph.read_instead(slot, *twin);
            } else {
                self.known.insert(slot, (*twin, mask));
            }
        }
        Ok(Some(GraphStep {
            inputs,
            outputs,
            ..step.clone()
        }))
    }

    /// A constant in the shape of a slot's value.
    fn filled(&self, slot: Slot, with: f32) -> Result<Value> {
        let shape = self.values[slot].as_ref().ok_or(NEVER_COMPUTED)?.shape();
        let count = shape.iter().product();
        Floats::new(vec![with; count], &shape, &self.device).map(Value::Floats)
    }
}

fn holds_only_logits(mask: &Option<Value>) -> Result<bool> {
    match mask {
        Some(Value::Floats(mask)) => Ok(mask.values()?.iter().all(|v| *v == 1.0)),
        _ => Ok(false),
    }
}
