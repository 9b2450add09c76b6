//! A network as steps between numbered places.

use std::collections::{BTreeMap, BTreeSet};

use burn::tensor::Device;

use super::operator::{AnyOperator, Inputs};
use super::value::Value;
use crate::whitebox::NetworkFault;

pub(super) type Place = usize;

#[derive(Clone)]
pub(super) struct Step {
    /// For messages: the node's name in the file.
    pub name: String,
    pub operator: AnyOperator,
    pub inputs: Vec<Option<Place>>,
    pub outputs: Vec<Place>,
}

/// In the order they are to be run.
pub(super) struct Graph {
    pub device: Device,
    pub steps: Vec<Step>,
    pub constants: BTreeMap<Place, Value>,
    pub input: Place,
    /// Name and place.
    pub outputs: Vec<(String, Place)>,
    /// How many places there are.
    pub places: usize,
}

impl Graph {
    /// Every place's value, for a picture.
    pub(super) fn run_all(&self, picture: Value) -> Result<Vec<Option<Value>>, NetworkFault> {
        let mut values = self.start(picture);
        for step in &self.steps {
            let inputs = step.inputs.iter().map(|place| values[(*place)?].clone()).collect();
            step.run(self.inputs(inputs), &mut values)?;
        }
        Ok(values)
    }

    /// The outputs for a picture, in order; what no later step needs is given up on the way.
    pub(super) fn run(&self, picture: Value) -> Result<Vec<Value>, NetworkFault> {
        let mut values = self.start(picture);
        let last_uses = self.last_uses();
        for (step, last_uses) in self.steps.iter().zip(last_uses) {
            let inputs = step.inputs.iter().map(|place| match last_uses.contains(&(*place)?) {
                true => values[(*place)?].take(),
                false => values[(*place)?].clone(),
            });
            let inputs = self.inputs(inputs.collect());
            step.run(inputs, &mut values)?;
        }
        let outputs = self.outputs.iter().map(|(name, place)| {
            let value = values[*place].clone();
            value.ok_or_else(|| NetworkFault::NotComputed(name.clone()))
        });
        outputs.collect()
    }

    /// For each step, the places no later step or output reads, read once by the step itself.
    fn last_uses(&self) -> Vec<BTreeSet<Place>> {
        let mut needed: BTreeSet<Place> = self.outputs.iter().map(|(_, place)| *place).collect();
        let mut uses: Vec<BTreeSet<Place>> = Vec::new();
        for step in self.steps.iter().rev() {
            let read = step.inputs.iter().flatten();
            let once = read
                .clone()
                .filter(|p| step.inputs.iter().flatten().filter(|q| q == p).count() == 1);
            uses.push(once.filter(|place| !needed.contains(place)).copied().collect());
            needed.extend(read);
        }
        uses.reverse();
        uses
    }

    fn inputs(&self, values: Vec<Option<Value>>) -> Inputs<'_> {
        Inputs {
            values,
            device: &self.device,
        }
    }

    fn start(&self, picture: Value) -> Vec<Option<Value>> {
        let mut values = vec![None; self.places];
        for (place, value) in &self.constants {
            values[*place] = Some(value.clone());
        }
        values[self.input] = Some(picture);
        values
    }

    /// Turns into constants what does not follow the picture, and drops what leads to no output. `values`: of [`Graph::run_all`] on a
    /// picture that is followed.
    pub(super) fn settle(&mut self, values: &[Option<Value>]) {
        let steps = std::mem::take(&mut self.steps);
        let is_followed = |place: &Place| values[*place].as_ref().is_some_and(Value::is_followed);
        let (followed, fixed): (Vec<Step>, Vec<Step>) =
            steps.into_iter().partition(|step| step.outputs.iter().any(is_followed));
        for place in fixed.iter().flat_map(|step| &step.outputs) {
            if let Some(value) = &values[*place] {
                self.constants.insert(*place, value.clone());
            }
        }
        self.steps = followed;
        self.prune();
    }

    fn prune(&mut self) {
        let mut needed: BTreeSet<Place> = self.outputs.iter().map(|(_, place)| *place).collect();
        let mut kept = Vec::new();
        for step in std::mem::take(&mut self.steps).into_iter().rev() {
            if step.outputs.iter().any(|place| needed.contains(place)) {
                needed.extend(step.inputs.iter().flatten());
                kept.push(step);
            }
        }
        kept.reverse();
        self.steps = kept;
        self.constants.retain(|place, _| needed.contains(place));
    }

    /// A place of its own.
    pub(super) fn new_place(&mut self) -> Place {
        self.places += 1;
        self.places - 1
    }
}

impl Step {
    fn run(&self, inputs: Inputs, values: &mut [Option<Value>]) -> Result<(), NetworkFault> {
        let outputs = self.operator.run(inputs).map_err(|fault| NetworkFault::At {
            node: self.name.clone(),
            fault: fault.into(),
        })?;
        for (place, value) in self.outputs.iter().zip(outputs) {
            values[*place] = Some(value);
        }
        Ok(())
    }
}
