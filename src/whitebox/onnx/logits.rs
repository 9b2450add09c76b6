//! The numbers before a network's last sigmoids.
//!
//! A confidence near 1 has no fractions left in 32 bits: from a logit of 17 on, σ is 1, `−ln(1 − C)` infinite and its gradient 0 · ∞. Where
//! outputs are sigmoids that were only moved about afterwards, the network is therefore run up to their logits instead, and σ is left to
//! the reader of the outputs, in 64 bits.

use std::collections::BTreeMap;

use burn::tensor::Device;

use super::graph::{Graph, Place, Step};
use super::operator::{Inputs, Moves};
use super::value::{Floats, Value};
use crate::whitebox::NetworkFault;

/// Leads the outputs past the last sigmoids. Answers, for each output, which of its numbers are logits now. `values`: of
/// [`Graph::run_all`].
pub(super) fn uncover(graph: &mut Graph, values: &[Option<Value>]) -> Result<Vec<Vec<bool>>, NetworkFault> {
    let mut twins = Twins {
        makers: makers(graph),
        known: BTreeMap::new(),
        values,
    };
    let mut masks = Vec::new();
    for i in 0..graph.outputs.len() {
        let twin = twins.of(graph, graph.outputs[i].1)?;
        graph.outputs[i].1 = twin.place;
        masks.push(match twin.is_logit {
            Some(Value::Floats(mask)) => mask.values()?.iter().map(|v| *v > 0.5).collect(),
            _ => Vec::new(),
        });
    }
    Ok(masks)
}

/// Which step makes a place, and which of its outputs that is.
fn makers(graph: &Graph) -> BTreeMap<Place, (usize, usize)> {
    let outputs = |i: usize| {
        graph.steps[i]
            .outputs
            .iter()
            .enumerate()
            .map(move |(k, place)| (*place, (i, k)))
    };
    (0..graph.steps.len()).flat_map(outputs).collect()
}

/// A value with the logits in place of their sigmoids.
#[derive(Clone)]
struct Twin {
    place: Place,
    /// 1 where it holds a logit, 0 elsewhere; `None` when it holds none.
    is_logit: Option<Value>,
}

struct Twins<'a> {
    makers: BTreeMap<Place, (usize, usize)>,
    known: BTreeMap<Place, Twin>,
    values: &'a [Option<Value>],
}

impl Twins<'_> {
    fn of(&mut self, graph: &mut Graph, place: Place) -> Result<Twin, NetworkFault> {
        if let Some(known) = self.known.get(&place) {
            return Ok(known.clone());
        }
        let itself = Twin { place, is_logit: None };
        let twin = match self.makers.get(&place) {
            None => itself,
            Some(&(step, output)) => {
                let step = graph.steps[step].clone();
                match (step.operator.is_sigmoid(), step.operator.moves()) {
                    (true, _) => self.before(graph, &step, place)?,
                    (false, Moves::Nothing) => itself,
                    (false, moves) => self.moved(graph, &step, output, moves)?.unwrap_or(itself),
                }
            }
        };
        self.known.insert(place, twin.clone());
        Ok(twin)
    }

    /// A sigmoid's input.
    fn before(&self, graph: &Graph, sigmoid: &Step, place: Place) -> Result<Twin, NetworkFault> {
        let logits = sigmoid
            .inputs
            .first()
            .copied()
            .flatten()
            .ok_or("a sigmoid has no input")?;
        Ok(Twin {
            place: logits,
            is_logit: Some(self.filled(place, 1.0, &graph.device)?),
        })
    }

    /// The same move, of the twins of what is moved; `None` when none of it holds a logit.
    fn moved(
        &mut self,
        graph: &mut Graph,
        step: &Step,
        output: usize,
        moves: Moves,
    ) -> Result<Option<Twin>, NetworkFault> {
        let moved = if moves == Moves::All { step.inputs.len() } else { 1 };
        let (mut inputs, mut masks, mut has_logits) = (step.inputs.clone(), Vec::new(), false);
        for (i, input) in step.inputs.iter().enumerate() {
            masks.push(match input {
                Some(place) if i < moved => {
                    let twin = self.of(graph, *place)?;
                    inputs[i] = Some(twin.place);
                    has_logits |= twin.is_logit.is_some();
                    Some(match twin.is_logit {
                        Some(mask) => mask,
                        None => self.filled(*place, 0.0, &graph.device)?,
                    })
                }
                Some(place) => self.values[*place].clone(),
                None => None,
            });
        }
        if !has_logits {
            return Ok(None);
        }
        let mut masks = step.operator.run(Inputs {
            values: masks,
            device: &graph.device,
        })?;
        let outputs: Vec<Place> = step.outputs.iter().map(|_| graph.new_place()).collect();
        let place = outputs[output];
        graph.steps.push(Step {
            inputs,
            outputs,
            ..step.clone()
        });
        let is_logit = Some(masks.swap_remove(output));
        Ok(Some(Twin { place, is_logit }))
    }

    /// A constant in the shape of a place's value.
    fn filled(&self, place: Place, with: f32, device: &Device) -> Result<Value, NetworkFault> {
        let shape = self.values[place].as_ref().ok_or("a value is never computed")?.shape();
        let count = shape.iter().product();
        Floats::new(vec![with; count], &shape, device).map(Value::Floats)
    }
}
