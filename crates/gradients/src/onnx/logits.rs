//! The numbers before a network's last sigmoids.
//!
//! A confidence near 1 has no fractions left in 32 bits: from a logit of 17 on, σ is 1, `−ln(1 − C)` infinite and its gradient 0 · ∞. Where
//! outputs are sigmoids that were only moved about afterwards, the network is therefore run up to their logits instead, and σ is left to
//! the reader of the outputs, in 64 bits.

use std::collections::{BTreeMap, BTreeSet};

use burn::tensor::Device;

use super::graph::{Graph, GraphStep, Slot};
use super::operator::{Inputs, Rearranged};
use super::value::{Floats, Value};
use crate::NetworkFault;

/// Leads the outputs past the last sigmoids. Answers, for each output, which of its numbers are logits now. `values`: of
/// [`Graph::run_all`].
pub(super) fn expose_logits(graph: &mut Graph, values: &[Option<Value>]) -> Result<Vec<Vec<bool>>, NetworkFault> {
    let mut twins = Twins {
        makers: makers(graph),
        known: BTreeMap::new(),
        added: Vec::new(),
        values,
    };
    // In the order of the steps: no twin waits for another, however long the chain, and what reads a list's new order is copied after it.
    let asked = moved_to_outputs(graph);
    for i in 0..graph.steps.len() {
        for slot in graph.steps[i].outputs.clone() {
            if asked.contains(&slot) {
                twins.of(graph, slot)?;
            }
        }
    }
    let mut masks = Vec::new();
    for i in 0..graph.outputs.len() {
        let twin = twins.of(graph, graph.outputs[i].1)?;
        graph.outputs[i].1 = twin.slot;
        masks.push(match twin.is_logit {
            Some(Value::Floats(mask)) => mask.values()?.iter().map(|v| *v > 0.5).collect(),
            _ => Vec::new(),
        });
    }
    twins.added.sort_by_key(|(after, _)| *after);
    let mut added = twins.added.into_iter().peekable();
    let steps = std::mem::take(&mut graph.steps).into_iter().enumerate();
    for (i, step) in steps {
        graph.steps.push(step);
        while let Some((_, twin)) = added.next_if(|(after, _)| *after == i) {
            graph.steps.push(twin);
        }
    }
    Ok(masks)
}

/// The outputs, and whatever is only moved on the way to them.
fn moved_to_outputs(graph: &Graph) -> BTreeSet<Slot> {
    let mut asked: BTreeSet<Slot> = graph.outputs.iter().map(|(_, slot)| *slot).collect();
    for step in graph.steps.iter().rev() {
        if step.outputs.iter().any(|slot| asked.contains(slot)) {
            let moved = match step.operator.rearranged {
                Rearranged::Nothing => 0,
                Rearranged::All => step.inputs.len(),
                Rearranged::First | Rearranged::Ordered => 1,
            };
            asked.extend(step.inputs.iter().take(moved).flatten());
        }
    }
    asked
}

/// Which step makes a slot, and which of its outputs that is.
fn makers(graph: &Graph) -> BTreeMap<Slot, (usize, usize)> {
    let outputs = |i: usize| {
        graph.steps[i]
            .outputs
            .iter()
            .enumerate()
            .map(move |(k, slot)| (*slot, (i, k)))
    };
    (0..graph.steps.len()).flat_map(outputs).collect()
}

/// A value with the logits in place of their sigmoids.
#[derive(Clone)]
struct Twin {
    slot: Slot,
    /// 1 where it holds a logit, 0 elsewhere; `None` when it holds none.
    is_logit: Option<Value>,
}

struct Twins<'a> {
    makers: BTreeMap<Slot, (usize, usize)>,
    known: BTreeMap<Slot, Twin>,
    /// New steps, each with the number of the step it comes after.
    added: Vec<(usize, GraphStep)>,
    values: &'a [Option<Value>],
}

impl Twins<'_> {
    fn of(&mut self, graph: &mut Graph, slot: Slot) -> Result<Twin, NetworkFault> {
        if let Some(known) = self.known.get(&slot) {
            return Ok(known.clone());
        }
        let itself = Twin { slot, is_logit: None };
        let twin = match self.makers.get(&slot) {
            None => itself,
            Some(&(at, output)) => {
                let step = graph.steps[at].clone();
                match (step.operator.is_sigmoid, step.operator.rearranged) {
                    (true, _) => self.before(graph, &step, slot)?,
                    (false, Rearranged::Nothing) => itself,
                    (false, rearranged) => self.moved(graph, at, output, rearranged)?.unwrap_or(itself),
                }
            }
        };
        self.known.insert(slot, twin.clone());
        Ok(twin)
    }

    /// A sigmoid's input.
    fn before(&self, graph: &Graph, sigmoid: &GraphStep, slot: Slot) -> Result<Twin, NetworkFault> {
        let logits = sigmoid
            .inputs
            .first()
            .copied()
            .flatten()
            .ok_or("a sigmoid has no input")?;
        Ok(Twin {
            slot: logits,
            is_logit: Some(self.filled(slot, 1.0, &graph.device)?),
        })
    }

    /// Repeats a step that only moves numbers, on the twins of what it moves. `None` when none of it holds a logit, or when a sort would mix logits
    /// with scores or its indices are asked for.
    fn moved(
        &mut self,
        graph: &mut Graph,
        at: usize,
        output: usize,
        rearranged: Rearranged,
    ) -> Result<Option<Twin>, NetworkFault> {
        let step = graph.steps[at].clone();
        let moved = if rearranged == Rearranged::All {
            step.inputs.len()
        } else {
            1
        };
        let (mut inputs, mut masks, mut has_logits) = (step.inputs.clone(), Vec::new(), false);
        for (i, input) in step.inputs.iter().enumerate() {
            masks.push(match input {
                Some(slot) if i < moved => {
                    let twin = self.of(graph, *slot)?;
                    inputs[i] = Some(twin.slot);
                    has_logits |= twin.is_logit.is_some();
                    Some(match twin.is_logit {
                        Some(mask) => mask,
                        None => self.filled(*slot, 0.0, &graph.device)?,
                    })
                }
                Some(slot) => self.values[*slot].clone(),
                None => None,
            });
        }
        if !has_logits {
            return Ok(None);
        }
        // Logits and scores have one order, a mixture of them has none.
        let is_ordered = rearranged == Rearranged::Ordered;
        if is_ordered && (output != 0 || !holds_only_logits(masks.first())?) {
            return Ok(None);
        }
        let mut masks = (step.operator.run)(Inputs {
            values: masks,
            device: &graph.device,
        })?;
        let outputs: Vec<Slot> = step.outputs.iter().map(|_| graph.new_slot()).collect();
        let slot = outputs[output];
        if is_ordered {
            // Scores that round to the same number are ordered by their logits alone: the indices have to be of that order, too.
            let [_, of_scores, ..] = step.outputs[..] else {
                return Ok(None);
            };
            graph.read_instead(of_scores, outputs[1]);
        }
        let twin = GraphStep {
            inputs,
            outputs,
            ..step
        };
        self.added.push((at, twin));
        let is_logit = Some(masks.swap_remove(output));
        Ok(Some(Twin { slot, is_logit }))
    }

    /// A constant in the shape of a slot's value.
    fn filled(&self, slot: Slot, with: f32, device: &Device) -> Result<Value, NetworkFault> {
        let shape = self.values[slot].as_ref().ok_or("a value is never computed")?.shape();
        let count = shape.iter().product();
        Floats::new(vec![with; count], &shape, device).map(Value::Floats)
    }
}

fn holds_only_logits(mask: Option<&Option<Value>>) -> Result<bool, NetworkFault> {
    match mask {
        Some(Some(Value::Floats(mask))) => Ok(mask.values()?.iter().all(|v| *v == 1.0)),
        _ => Ok(false),
    }
}
