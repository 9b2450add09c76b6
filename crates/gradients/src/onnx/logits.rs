//! The numbers before a network's last sigmoids.
//!
//! A confidence near 1 has no fractions left in 32 bits: from a logit of 17 on, σ is 1, `−ln(1 − C)` infinite and its gradient 0 · ∞. Where
//! outputs are sigmoids that were only moved about afterwards, the network is therefore run up to their logits instead, and σ is left to
//! the reader of the outputs, in 64 bits.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::graph::Graph;
use super::run::{Step, Work};
use super::term::{Term, Value};
use crate::layers::tape::Slot;
use crate::layers::{Moved, Number};

/// Leads outputs past the last sigmoids. Answers, for each, which of its numbers are logits now; nothing where none is.
pub(super) fn expose_logits<T: Number>(graph: &mut Graph<T>, outputs: &mut [Term<T>]) -> Vec<Vec<bool>> {
    let asked = moved_to(graph, outputs);
    let mut twins = Twins {
        known: BTreeMap::new(),
        instead: BTreeMap::new(),
    };
    for mut step in std::mem::take(&mut graph.steps) {
        twins.redirect(&mut step.inputs);
        let output = step.output;
        let mut twin = Vec::new();
        if asked.contains(&output) && matches!(step.work, Work::Sigmoid) {
            let is_logit = vec![true; graph.counts[output]];
            twins.known.insert(output, (step.inputs[0], is_logit));
        } else if asked.contains(&output) {
            twin = twins.moved(graph, &step);
        }
        graph.steps.push(step);
        graph.steps.extend(twin);
    }
    let masks = outputs.iter_mut().map(|output| match &mut output.value {
        Value::Image(slot, _) => {
            twins.redirect(std::slice::from_mut(slot));
            let twin = twins.known.get(slot).cloned();
            let (twin, mask) = twin.unwrap_or((*slot, Vec::new()));
            *slot = twin;
            mask
        }
        Value::Constant(_) => Vec::new(),
    });
    masks.collect()
}

/// The slots whose numbers are moved into outputs.
fn moved_to<T: Number>(graph: &Graph<T>, outputs: &[Term<T>]) -> BTreeSet<Slot> {
    let mut asked: BTreeSet<Slot> = outputs.iter().filter_map(Term::slot).collect();
    for step in graph.steps.iter().rev().filter(|step| step.is_followed) {
        let moved = match step.work {
            Work::Moved(_) => step.inputs.len(),
            Work::Picked(_) => 1,
            _ => 0,
        };
        if asked.contains(&step.output) {
            asked.extend(&step.inputs[..moved]);
        }
    }
    asked
}

/// Slots with the logits in place of their sigmoids.
struct Twins {
    /// For a slot that holds sigmoids, the slot of its twin, and which numbers of that are logits.
    known: BTreeMap<Slot, (Slot, Vec<bool>)>,
    /// Orders of sigmoids, and those of their logits. Scores that round to the same number are ordered by their logits alone.
    instead: BTreeMap<Slot, Slot>,
}

impl Twins {
    fn redirect(&self, slots: &mut [Slot]) {
        for slot in slots {
            *slot = *self.instead.get(slot).unwrap_or(slot);
        }
    }

    /// The steps that repeat one that only moves numbers, on the twins of what it moves; none where none of it is a logit, or where logits would be
    /// mixed with scores in an order.
    fn moved<T: Number>(&mut self, graph: &mut Graph<T>, step: &Step<T>) -> Vec<Step<T>> {
        match &step.work {
            Work::Moved(moved) if step.is_followed => self.of_moved(graph, step, moved).into_iter().collect(),
            Work::Picked(_) => self.of_picked(graph, step),
            _ => Vec::new(),
        }
    }

    fn of_moved<T: Number>(&mut self, graph: &mut Graph<T>, step: &Step<T>, moved: &Moved) -> Option<Step<T>> {
        if !step.inputs.iter().any(|slot| self.known.contains_key(slot)) {
            return None;
        }
        let twin = |slot: &Slot| {
            let known = self.known.get(slot).cloned();
            known.unwrap_or_else(|| (*slot, vec![false; graph.counts[*slot]]))
        };
        let (inputs, masks): (Vec<Slot>, Vec<Vec<bool>>) = step.inputs.iter().map(twin).unzip();
        let masks: Vec<&[bool]> = masks.iter().map(Vec::as_slice).collect();
        Some(self.twin(graph, step, inputs, moved.of(&masks)))
    }

    fn of_picked<T: Number>(&mut self, graph: &mut Graph<T>, step: &Step<T>) -> Vec<Step<T>> {
        let (from, indices) = (step.inputs[0], step.inputs[1]);
        let Some((twin, _)) = self
            .known
            .get(&from)
            .filter(|(_, mask)| mask.iter().all(|is_logit| *is_logit))
            .cloned()
        else {
            return Vec::new();
        };
        let is_own = |step: &&Step<T>| step.output == indices && step.inputs == [from];
        let order = graph.steps.iter().rev().find(is_own);
        let order = order.filter(|step| matches!(step.work, Work::Order(_)));
        let order = order.map(|step| (step.work.clone(), Arc::clone(&step.node)));
        let (mut steps, mut indices) = (Vec::new(), indices);
        if let Some((work, node)) = order {
            let output = graph.new_slot(graph.counts[indices]);
            self.instead.insert(indices, output);
            indices = output;
            steps.push(Step {
                node,
                work,
                inputs: vec![twin],
                output,
                is_followed: false,
            });
        }
        let mask = vec![true; graph.counts[step.output]];
        steps.push(self.twin(graph, step, vec![twin, indices], mask));
        steps
    }

    fn twin<T: Number>(&mut self, graph: &mut Graph<T>, step: &Step<T>, inputs: Vec<Slot>, mask: Vec<bool>) -> Step<T> {
        let output = graph.new_slot(graph.counts[step.output]);
        self.known.insert(step.output, (output, mask));
        Step {
            node: step.node.clone(),
            work: step.work.clone(),
            inputs,
            output,
            is_followed: true,
        }
    }
}
