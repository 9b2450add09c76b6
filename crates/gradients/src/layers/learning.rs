//! Networks whose weights are learnt from samples.

use std::collections::BTreeSet;
use std::sync::Arc;

use scaleproof_core::workers;

use super::by_weights::LearntConvolution;
use super::convolution::convolution;
use super::tape::{Recorded, Slot, Tape, backward, last_uses, taken};
use super::{Activation, Array, Back, Layer, Moved, Operation, Pairwise, Sums, Weights, Windows, owned, vectorised};

/// The variables of derivatives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum By {
    /// Weights and biases of every convolution.
    Weights,
    Image,
}

/// The image, or what a layer makes.
#[derive(Debug, Clone, Copy)]
pub struct Output {
    slot: Slot,
    channels: usize,
    /// Rows and columns.
    size: [usize; 2],
}

impl Output {
    fn count(self) -> usize {
        self.channels * self.size[0] * self.size[1]
    }
}

/// A convolution's kernel, and how it moves.
#[derive(Debug, Clone, Copy)]
pub struct Kernel {
    /// Rows, and columns.
    pub size: usize,
    pub stride: usize,
    /// Zeros on every side of the image.
    pub padding: usize,
}

struct Step {
    layer: Box<dyn Layer>,
    inputs: Vec<Slot>,
    /// Slots of the derivatives: those of the inputs, then of weights and biases.
    slots: Vec<Slot>,
    output: Slot,
}

/// Layers in the order in which they run; the last one's output is the network's.
pub struct Network {
    by: By,
    image: Output,
    steps: Vec<Step>,
    /// The number of images, outputs and lists of weights.
    slots: usize,
    /// Slots of what is learnt, and how many numbers are in each.
    learnt: Vec<(usize, usize)>,
}

impl Network {
    /// One without layers, and its image.
    pub fn new(channels: usize, size: [usize; 2], by: By) -> (Self, Output) {
        let slot = 0;
        let image = Output { slot, channels, size };
        let network = Self {
            by,
            image,
            steps: Vec::new(),
            slots: 1,
            learnt: Vec::new(),
        };
        (network, image)
    }

    fn slot(&mut self) -> usize {
        self.slots += 1;
        self.slots - 1
    }

    fn then(&mut self, layer: Box<dyn Layer>, of: &[Output], channels: usize, size: [usize; 2]) -> Output {
        let slot = self.slot();
        let inputs: Vec<usize> = of.iter().map(|output| output.slot).collect();
        self.steps.push(Step {
            layer,
            slots: inputs.clone(),
            inputs,
            output: slot,
        });
        Output { slot, channels, size }
    }

    /// `weights`: outputs × channels × kernel. They are what is learnt next, and the biases, one an output, after them.
    pub fn convolution(&mut self, x: Output, kernel: Kernel, [weights, biases]: [&[f32]; 2]) -> Output {
        let along = |axis: usize| (x.size[axis] + 2 * kernel.padding - kernel.size) / kernel.stride + 1;
        let windows = Windows {
            channels: x.channels,
            image: x.size,
            kernel: [kernel.size; 2],
            stride: [kernel.stride; 2],
            dilation: [1; 2],
            before: [kernel.padding; 2],
            count: [along(0), along(1)],
        };
        let (count, outputs) = (windows.count, biases.len());
        let own = Weights {
            groups: 1,
            weights: weights.to_vec(),
            biases: Some(biases.to_vec()),
            outputs,
        };
        if self.by == By::Image {
            return self.then(convolution(windows, own), &[x], outputs, count);
        }
        let layer = LearntConvolution::new(windows, own, x.slot != self.image.slot);
        let lists = [weights, biases].map(|list| (self.slot(), list.len()));
        let output = self.then(Box::new(layer), &[x], outputs, count);
        if let Some(step) = self.steps.last_mut() {
            step.slots.extend(lists.map(|(slot, _)| slot));
        }
        self.learnt.extend(lists);
        output
    }

    /// Every output from all numbers of x: a convolution of one pixel, whose channels these are.
    pub fn linear(&mut self, x: Output, lists: [&[f32]; 2]) -> Output {
        let kernel = Kernel {
            size: 1,
            stride: 1,
            padding: 0,
        };
        let pixel = Output {
            slot: x.slot,
            channels: x.count(),
            size: [1, 1],
        };
        self.convolution(pixel, kernel, lists)
    }

    pub fn relu(&mut self, x: Output) -> Output {
        self.then(Box::new(Activation::LeakyRelu(0.0)), &[x], x.channels, x.size)
    }

    /// The sum of two outputs of one shape.
    pub fn sum(&mut self, a: Output, b: Output) -> Output {
        let layer = Pairwise::new(Operation::Sum);
        self.then(Box::new(layer), &[a, b], a.channels, a.size)
    }

    /// The channels of two outputs of one size.
    pub fn joined(&mut self, a: Output, b: Output) -> Output {
        let all: Vec<usize> = (0..a.count() + b.count()).collect();
        let layer = Moved::new(vec![a.count(), b.count()], &all);
        self.then(Box::new(layer), &[a, b], a.channels + b.channels, a.size)
    }

    /// Each number four times, in an image of twice the size.
    pub fn doubled(&mut self, x: Output) -> Output {
        let layer = Doubling { columns: x.size[1] };
        self.then(Box::new(layer), &[x], x.channels, x.size.map(|n| 2 * n))
    }

    /// The network's output for an image.
    pub fn output(&self, image: Vec<f32>) -> Vec<f32> {
        owned(self.run(image, &self.last_uses(), false).0)
    }

    /// The sum over samples of a loss of the output for each one's image, and its derivatives by every list that is learnt, or by the image. `loss` gives
    /// a sample's loss and its derivative by the output. A thread computes one sample after the other; sums are taken in the samples' order.
    pub fn loss_and_derivatives<S: Sync>(
        &self,
        samples: &[S],
        image: impl Fn(&S) -> Vec<f32> + Sync,
        loss: impl Fn(&S, &[f32]) -> (f64, Vec<f32>) + Sync,
    ) -> (f64, Vec<Vec<f32>>) {
        let last_uses = self.last_uses();
        let parts = workers::each(samples, |sample| {
            let (output, tape) = self.run(image(sample), &last_uses, true);
            let (loss, gradient) = loss(sample, &output);
            (loss, self.back(gradient, tape))
        });
        let mut sums: Vec<_> = self.ends().map(|(_, count)| vec![0.0; count]).collect();
        for (_, lists) in &parts {
            for (sum, list) in sums.iter_mut().zip(lists) {
                vectorised(|| sum.iter_mut().zip(list).for_each(|(sum, v)| *sum += v));
            }
        }
        (parts.iter().map(|(loss, _)| loss).sum(), sums)
    }

    /// The slots of the derivatives that are asked for, and how many numbers are in each.
    fn ends(&self) -> impl Iterator<Item = (usize, usize)> {
        let image = (self.by == By::Image).then_some((self.image.slot, self.image.count()));
        self.learnt.iter().copied().chain(image)
    }

    /// Slot of the network's output.
    fn last(&self) -> Slot {
        self.steps.last().map_or(self.image.slot, |step| step.output)
    }

    /// Returns for each step the slots that no later step reads.
    fn last_uses(&self) -> Vec<BTreeSet<Slot>> {
        last_uses(self.steps.iter().map(|step| &step.inputs[..]), [])
    }

    fn run(&self, image: Vec<f32>, last_uses: &[BTreeSet<Slot>], keeps: bool) -> (Array, Tape<'_>) {
        let mut values: Vec<Array> = vec![Array::default(); self.slots];
        values[self.image.slot] = Arc::new(image);
        let mut tape = Tape::with_capacity(self.steps.len());
        for (step, last_uses) in self.steps.iter().zip(last_uses) {
            let inputs = step.inputs.iter().map(|slot| taken(&mut values, *slot, last_uses));
            let (output, back) = step.layer.forward(inputs.collect(), keeps);
            values[step.output] = output;
            let (output, slots) = (step.output, &step.slots[..]);
            tape.extend(back.map(|back| Recorded { output, slots, back }));
        }
        (std::mem::take(&mut values[self.last()]), tape)
    }

    fn back(&self, gradient: Vec<f32>, tape: Tape) -> Vec<Vec<f32>> {
        let mut all = backward(tape, self.slots, [(self.last(), gradient)]);
        let taken = |(slot, count): (usize, usize)| all[slot].take().unwrap_or_else(|| vec![0.0; count]);
        self.ends().map(taken).collect()
    }
}

/// Each number of an image four times, in two rows and two columns.
struct Doubling {
    columns: usize,
}

impl Layer for Doubling {
    fn forward(&self, inputs: Vec<Array>, keeps: bool) -> (Array, Option<Back<'_>>) {
        let mut doubled = Vec::with_capacity(4 * inputs[0].len());
        for row in inputs[0].chunks_exact(self.columns) {
            doubled.extend(row.iter().flat_map(|v| [*v; 2]));
            doubled.extend_from_within(doubled.len() - 2 * self.columns..);
        }
        let back = |gradient: Vec<f32>, sums: &mut Sums| {
            let pairs_of_rows = gradient.chunks_exact(4 * self.columns);
            let sums_of_four = pairs_of_rows.flat_map(|rows| {
                let (upper, lower) = rows.split_at(2 * self.columns);
                let both = upper.chunks_exact(2).zip(lower.chunks_exact(2));
                both.map(|(upper, lower)| upper[0] + upper[1] + lower[0] + lower[1])
            });
            sums.add(0, sums_of_four.collect());
        };
        (Arc::new(doubled), keeps.then(|| Box::new(back) as Back))
    }
}
