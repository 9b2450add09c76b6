//! A network as steps between numbered slots.

use std::collections::{BTreeMap, BTreeSet};

use burn::tensor::Device;

use super::operator::{Inputs, Operator};
use super::value::Value;
use crate::NetworkFault;

pub(super) type Slot = usize;

/// All numbers of all tensors of one image; those of the largest detectors are a tenth of this.
const MOST_KEPT: usize = 1 << 30;

#[derive(Clone)]
pub(super) struct GraphStep {
    /// For messages: the node's name in the file.
    pub name: String,
    pub operator: Operator,
    pub inputs: Vec<Option<Slot>>,
    pub outputs: Vec<Slot>,
}

/// In the order they are to be run.
pub(super) struct Graph {
    pub device: Device,
    pub steps: Vec<GraphStep>,
    pub constants: BTreeMap<Slot, Value>,
    pub input: Slot,
    /// Name and slot.
    pub outputs: Vec<(String, Slot)>,
    pub slots: usize,
}

impl Graph {
    /// Every slot's value, for an image.
    pub(super) fn run_all(&self, image: Value) -> Result<Vec<Option<Value>>, NetworkFault> {
        let (mut values, mut kept) = (vec![None; self.slots], 0);
        for (slot, value) in &self.constants {
            values[*slot] = Some(value.clone());
        }
        values[self.input] = Some(image);
        for step in &self.steps {
            let inputs = step.inputs.iter().map(|slot| values[(*slot)?].clone()).collect();
            for (slot, value) in step.run(inputs, &self.device)? {
                kept += value.shape().iter().product::<usize>();
                values[slot] = Some(value);
            }
            if kept > MOST_KEPT {
                return Err(NetworkFault::TooLarge(MOST_KEPT));
            }
        }
        Ok(values)
    }

    /// Turns into constants what does not depend on the image's numbers, and drops what leads to no output. `values`: of
    /// [`Graph::run_all`].
    pub(super) fn fold_constants(&mut self, values: &[Option<Value>]) {
        let mut dependent = BTreeSet::from([self.input]);
        let Graph { steps, constants, .. } = self;
        steps.retain(|step| {
            let mut read = step.inputs.iter().flatten();
            let depends = !step.operator.reads_shapes_only && read.any(|slot| dependent.contains(slot));
            for slot in &step.outputs {
                match &values[*slot] {
                    _ if depends => _ = dependent.insert(*slot),
                    Some(value) => _ = constants.insert(*slot, value.clone()),
                    None => {}
                }
            }
            depends
        });
        self.prune();
    }

    fn prune(&mut self) {
        let mut needed: BTreeSet<Slot> = self.outputs.iter().map(|(_, slot)| *slot).collect();
        self.steps.reverse();
        self.steps.retain(|step| {
            let is_needed = step.outputs.iter().any(|slot| needed.contains(slot));
            if is_needed {
                needed.extend(step.inputs.iter().flatten());
            }
            is_needed
        });
        self.steps.reverse();
        self.constants.retain(|slot, _| needed.contains(slot));
    }

    /// Whatever reads a slot reads another from now on.
    pub(super) fn read_instead(&mut self, slot: Slot, other: Slot) {
        let inputs = self.steps.iter_mut().flat_map(|step| step.inputs.iter_mut().flatten());
        let outputs = self.outputs.iter_mut().map(|(_, slot)| slot);
        let read = inputs.chain(outputs).filter(|read| **read == slot);
        read.for_each(|read| *read = other);
    }

    pub(super) fn new_slot(&mut self) -> Slot {
        self.slots += 1;
        self.slots - 1
    }
}

impl GraphStep {
    pub(super) fn run(
        &self,
        values: Vec<Option<Value>>,
        device: &Device,
    ) -> Result<impl Iterator<Item = (Slot, Value)>, NetworkFault> {
        let outputs = (self.operator.run)(Inputs { values, device });
        let outputs = outputs.map_err(|fault| NetworkFault::At(self.name.clone(), fault.into()))?;
        Ok(self.outputs.iter().copied().zip(outputs))
    }
}

/// For each step that reads some slots, those that no later step reads and that are not among what is `needed` at the end; what the step
/// itself reads twice is none of them.
pub(super) fn last_uses(read: &[Vec<Slot>], needed: impl IntoIterator<Item = Slot>) -> Vec<BTreeSet<Slot>> {
    let mut needed: BTreeSet<Slot> = needed.into_iter().collect();
    let mut uses: Vec<BTreeSet<Slot>> = Vec::new();
    for read in read.iter().rev() {
        let is_read_once = |slot: &&Slot| read.iter().filter(|other| other == slot).count() == 1;
        let last = read.iter().filter(is_read_once).filter(|slot| !needed.contains(slot));
        uses.push(last.copied().collect());
        needed.extend(read);
    }
    uses.reverse();
    uses
}
