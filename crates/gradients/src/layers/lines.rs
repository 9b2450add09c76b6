//! Reductions along an axis: sums, means, the largest, softmax.

use std::sync::Arc;

use super::{Array, Back, Layer, Number, Sums, owned};

/// Partial sums that are added up at a time.
const LANES: usize = 16;

/// The lines of numbers along an axis.
#[derive(Debug, Clone, Copy)]
pub struct Lines {
    /// Numbers of a line.
    pub side: usize,
    /// Step from one number of a line to the next; so many lines lie in between.
    pub step: usize,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Summary {
    Sum,
    Mean,
    Largest,
    Smallest,
}

/// One number for each line.
pub struct Reduced(pub Lines, pub Summary);

/// e^x as a share of its line's sum.
pub struct Softmax(pub Lines);

impl Lines {
    fn block(self) -> usize {
        self.side * self.step
    }
}

/// The sum of a line, in partial sums.
#[inline(always)]
pub(super) fn total<T: Number>(line: &[T]) -> T {
    let mut lanes = [T::ZERO; LANES];
    let (chunks, rest) = line.as_chunks::<LANES>();
    for chunk in chunks {
        lanes.iter_mut().zip(chunk).for_each(|(sum, v)| *sum += *v);
    }
    lanes.into_iter().chain(rest.iter().copied()).sum()
}

/// One block of lines to its sums or, with places, to its largest numbers.
struct Summed<'a, T> {
    lines: Lines,
    numbers: &'a [T],
    sums: &'a mut [T],
}

impl<T: Number> pulp::WithSimd for Summed<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        for (numbers, sums) in
            (self.numbers.chunks_exact(self.lines.block())).zip(self.sums.chunks_exact_mut(self.lines.step))
        {
            if let [sum] = sums {
                *sum = total(numbers);
                continue;
            }
            for row in numbers.chunks_exact(self.lines.step) {
                sums.iter_mut().zip(row).for_each(|(sum, v)| *sum += *v);
            }
        }
    }
}

impl Reduced {
    /// The largest or smallest number of each line, and its place in the line; of equals the first. What is not a number wins.
    fn extreme<T: Number>(&self, numbers: &[T], found: &mut [T]) -> Vec<u32> {
        let (lines, mut places) = (self.0, vec![0; found.len()]);
        let outputs = found
            .chunks_exact_mut(lines.step)
            .zip(places.chunks_exact_mut(lines.step));
        for (numbers, (found, places)) in numbers.chunks_exact(lines.block()).zip(outputs) {
            found.copy_from_slice(&numbers[..lines.step]);
            for (at, row) in numbers.chunks_exact(lines.step).enumerate().skip(1) {
                for ((best, place), v) in found.iter_mut().zip(&mut *places).zip(row) {
                    let is_better = match self.1 {
                        Summary::Smallest => *v < *best,
                        _ => *v > *best,
                    };
                    if is_better || v.is_nan() {
                        (*best, *place) = (*v, at as u32);
                    }
                }
            }
        }
        places
    }

    fn back<T: Number>(&self, gradient: &[T], places: &[u32], image: &mut [T]) {
        let lines = self.0;
        let share = match self.1 {
            Summary::Mean => T::ONE / T::of(lines.side as f64),
            _ => T::ONE,
        };
        let blocks = image
            .chunks_exact_mut(lines.block())
            .zip(gradient.chunks_exact(lines.step));
        for (block, (image, gradient)) in blocks.enumerate() {
            if places.is_empty() {
                for row in image.chunks_exact_mut(lines.step) {
                    row.iter_mut().zip(gradient).for_each(|(sum, g)| *sum += *g * share);
                }
            } else {
                let places = &places[block * lines.step..];
                for (i, (g, place)) in gradient.iter().zip(places).enumerate() {
                    image[*place as usize * lines.step + i] += *g;
                }
            }
        }
    }
}

impl<T: Number> Layer<T> for Reduced {
    fn forward(&self, inputs: Vec<Array<T>>, keeps: bool) -> (Array<T>, Option<Back<'_, T>>) {
        let (lines, numbers) = (self.0, &inputs[0]);
        let (count, mut places) = (numbers.len(), Vec::new());
        let mut output = vec![T::ZERO; count / lines.side];
        if matches!(self.1, Summary::Largest | Summary::Smallest) {
            places = self.extreme(numbers, &mut output);
        } else {
            let sums = &mut output;
            pulp::Arch::new().dispatch(Summed { lines, numbers, sums });
        }
        if self.1 == Summary::Mean {
            let side = T::of(lines.side as f64);
            output.iter_mut().for_each(|sum| *sum = *sum / side);
        }
        let back = move |gradient: Vec<T>, sums: &mut Sums<T>| self.back(&gradient, &places, sums.sum_mut(0, count));
        (Arc::new(output), keeps.then(|| Box::new(back) as Back<T>))
    }
}

/// All lines to their softmax, in place; or derivatives by it to those by the numbers, `softmax` being what it answered.
struct Shares<'a, T> {
    lines: Lines,
    numbers: &'a mut [T],
    softmax: Option<&'a [T]>,
}

impl<T: Number> Shares<'_, T> {
    #[inline(always)]
    fn forth(block: &mut [T], step: usize, of_lines: &mut [T]) {
        of_lines.fill(T::LEAST);
        for row in block.chunks_exact(step) {
            of_lines
                .iter_mut()
                .zip(row)
                .for_each(|(largest, v)| *largest = largest.larger(*v));
        }
        if let [largest] = of_lines {
            let from = *largest;
            block.iter_mut().for_each(|v| *v = (*v - from).exp());
            let sum = total(block);
            block.iter_mut().for_each(|v| *v = *v / sum);
            return;
        }
        for row in block.chunks_exact_mut(step) {
            row.iter_mut()
                .zip(&*of_lines)
                .for_each(|(v, from)| *v = (*v - *from).exp());
        }
        of_lines.fill(T::ZERO);
        for row in block.chunks_exact(step) {
            of_lines.iter_mut().zip(row).for_each(|(sum, v)| *sum += *v);
        }
        for row in block.chunks_exact_mut(step) {
            row.iter_mut().zip(&*of_lines).for_each(|(v, sum)| *v = *v / *sum);
        }
    }

    /// g becomes y · (g − Σ g · y).
    #[inline(always)]
    fn back(gradient: &mut [T], y: &[T], step: usize, of_lines: &mut [T]) {
        gradient.iter_mut().zip(y).for_each(|(g, y)| *g *= *y);
        if let [_] = of_lines {
            let sum = total(gradient);
            gradient.iter_mut().zip(y).for_each(|(g, y)| *g = *g - *y * sum);
            return;
        }
        of_lines.fill(T::ZERO);
        for row in gradient.chunks_exact(step) {
            of_lines.iter_mut().zip(row).for_each(|(sum, g)| *sum += *g);
        }
        for (row, y) in gradient.chunks_exact_mut(step).zip(y.chunks_exact(step)) {
            let of_row = row.iter_mut().zip(y).zip(&*of_lines);
            of_row.for_each(|((g, y), sum)| *g = *g - *y * *sum);
        }
    }
}

impl<T: Number> pulp::WithSimd for Shares<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let (step, block) = (self.lines.step, self.lines.block());
        let mut of_lines = vec![T::ZERO; step];
        for (i, numbers) in self.numbers.chunks_exact_mut(block).enumerate() {
            match self.softmax {
                None => Self::forth(numbers, step, &mut of_lines),
                Some(y) => Self::back(numbers, &y[i * block..][..block], step, &mut of_lines),
            }
        }
    }
}

impl<T: Number> Layer<T> for Softmax {
    fn forward(&self, mut inputs: Vec<Array<T>>, keeps: bool) -> (Array<T>, Option<Back<'_, T>>) {
        let lines = self.0;
        let mut y = owned(inputs.swap_remove(0));
        pulp::Arch::new().dispatch(Shares {
            lines,
            numbers: &mut y,
            softmax: None,
        });
        let y = Arc::new(y);
        let kept = y.clone();
        let back = move |mut gradient: Vec<T>, sums: &mut Sums<T>| {
            pulp::Arch::new().dispatch(Shares {
                lines,
                numbers: &mut gradient,
                softmax: Some(&kept),
            });
            sums.add(0, gradient);
        };
        (y, keeps.then(|| Box::new(back) as Back<T>))
    }
}
