//! Numbers put elsewhere: cut, joined, turned, repeated.

use std::sync::Arc;

use super::lines::total;
use super::{Array, Back, Layer, Number, Sums, vectorised};

/// Numbers that follow each other in the output and lie one step apart in one input.
#[derive(Debug, Clone, Copy)]
struct Run {
    input: usize,
    from: usize,
    step: isize,
    count: usize,
}

pub struct Moved {
    inputs: Vec<usize>,
    runs: Vec<Run>,
    count: usize,
}

impl Moved {
    /// For each number of the output, which one of all inputs' numbers it is, these counted on from input to input.
    pub fn new(inputs: Vec<usize>, indices: &[usize]) -> Self {
        let mut runs: Vec<Run> = Vec::new();
        for index in indices {
            let (mut input, mut from) = (0, *index);
            while from >= inputs[input] {
                from -= inputs[input];
                input += 1;
            }
            match runs.last_mut() {
                Some(run) if run.goes_on_at(input, from) => {
                    run.step = from as isize - run.place(run.count - 1) as isize;
                    run.count += 1;
                }
                _ => runs.push(Run {
                    input,
                    from,
                    step: 1,
                    count: 1,
                }),
            }
        }
        let count = indices.len();
        Moved { inputs, runs, count }
    }

    /// Returns whether the output is the only input.
    fn is_same(&self) -> bool {
        matches!(self.runs[..], [Run { from: 0, step: 1, count, .. }] if self.inputs == [count])
    }

    /// The output, of anything.
    pub fn of<N: Copy>(&self, inputs: &[&[N]]) -> Vec<N> {
        let mut output = Vec::with_capacity(self.count);
        for run in &self.runs {
            let from = inputs[run.input];
            match run.step {
                0 => output.resize(output.len() + run.count, from[run.from]),
                1 => output.extend_from_slice(&from[run.from..run.from + run.count]),
                _ => output.extend((0..run.count).map(|i| from[run.place(i)])),
            }
        }
        output
    }

    fn back<T: Number>(&self, gradient: Vec<T>, sums: &mut Sums<T>) {
        if self.is_same() {
            return sums.add(0, gradient);
        }
        let mut at = 0;
        for run in &self.runs {
            let part = &gradient[at..at + run.count];
            at += run.count;
            // What no derivative comes back to needs none.
            if part.iter().all(|g| *g == T::ZERO) {
                continue;
            }
            let sum = sums.sum_mut(run.input, self.inputs[run.input]);
            match run.step {
                1 => vectorised(|| {
                    let sums = sum[run.from..run.from + run.count].iter_mut();
                    sums.zip(part).for_each(|(sum, g)| *sum += *g)
                }),
                0 => sum[run.from] += vectorised(|| total(part)),
                _ => part.iter().enumerate().for_each(|(i, g)| sum[run.place(i)] += *g),
            }
        }
    }
}

impl Run {
    fn place(&self, i: usize) -> usize {
        self.from.wrapping_add_signed(self.step * i as isize)
    }

    fn goes_on_at(&self, input: usize, from: usize) -> bool {
        input == self.input && (self.count == 1 || from == self.place(self.count))
    }
}

impl<T: Number> Layer<T> for Moved {
    fn forward(&self, mut inputs: Vec<Array<T>>, keeps: bool) -> (Array<T>, Option<Back<'_, T>>) {
        let back = keeps.then(|| Box::new(|gradient: Vec<T>, sums: &mut Sums<T>| self.back(gradient, sums)) as Back<T>);
        if self.is_same() {
            return (inputs.swap_remove(0), back);
        }
        let inputs: Vec<&[T]> = inputs.iter().map(|input| &input[..]).collect();
        (Arc::new(self.of(&inputs)), back)
    }
}
