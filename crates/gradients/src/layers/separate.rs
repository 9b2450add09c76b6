//! Linear maps of each channel that treat rows and columns apart: resizing, averages, borders of zeros.

use std::sync::Arc;

use super::{Array, Back, Layer, Number, Sums};

/// For each new index of an axis, the old ones that it is made of, with their weights.
type Axis<T> = Vec<Vec<(usize, T)>>;

pub struct Separate<T = f32> {
    channels: usize,
    old: [usize; 2],
    rows: Axis<T>,
    columns: Axis<T>,
}

impl<T: Number> Separate<T> {
    /// `weights`: of rows and of columns, new × old, row-major.
    pub fn new(channels: usize, old: [usize; 2], weights: [Vec<T>; 2]) -> Self {
        let [rows, columns] = [0, 1].map(|i| -> Axis<T> {
            let nonzero = |row: &[T]| {
                let weights = row.iter().copied().enumerate();
                weights.filter(|(_, weight)| *weight != T::ZERO).collect()
            };
            weights[i].chunks_exact(old[i]).map(nonzero).collect()
        });
        Separate {
            channels,
            old,
            rows,
            columns,
        }
    }

    #[inline(always)]
    fn channel(&self, from: &[T], line: &mut [T], to: &mut [T]) {
        for (to, row) in to.chunks_exact_mut(self.columns.len()).zip(&self.rows) {
            line.fill(T::ZERO);
            for (y, weight) in row {
                let from = &from[y * self.old[1]..][..line.len()];
                (line.iter_mut().zip(from)).for_each(|(sum, v)| *sum = v.mul_add(*weight, *sum));
            }
            for (to, column) in to.iter_mut().zip(&self.columns) {
                *to = (column.iter()).fold(T::ZERO, |sum, (x, weight)| line[*x].mul_add(*weight, sum));
            }
        }
    }

    /// The transpose of [`Separate::channel`].
    #[inline(always)]
    fn channel_back(&self, gradient: &[T], line: &mut [T], to: &mut [T]) {
        for (gradient, row) in gradient.chunks_exact(self.columns.len()).zip(&self.rows) {
            line.fill(T::ZERO);
            for (g, column) in gradient.iter().zip(&self.columns) {
                (column.iter()).for_each(|(x, weight)| line[*x] = g.mul_add(*weight, line[*x]));
            }
            for (y, weight) in row {
                let to = &mut to[y * self.old[1]..][..line.len()];
                (to.iter_mut().zip(line.iter())).for_each(|(to, g)| *to = g.mul_add(*weight, *to));
            }
        }
    }
}

/// One channel, forward or back, by way of a line of old columns.
struct Channel<'a, T> {
    map: &'a Separate<T>,
    is_back: bool,
    from: &'a [T],
    line: &'a mut [T],
    to: &'a mut [T],
}

impl<T: Number> pulp::WithSimd for Channel<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        if self.is_back {
            self.map.channel_back(self.from, self.line, self.to);
        } else {
            self.map.channel(self.from, self.line, self.to);
        }
    }
}

impl<T: Number> Layer<T> for Separate<T> {
    fn forward(&self, inputs: Vec<Array<T>>, keeps: bool) -> (Array<T>, Option<Back<'_, T>>) {
        let (old_area, area) = (self.old.iter().product(), self.rows.len() * self.columns.len());
        let mut output = vec![T::ZERO; self.channels * area];
        let mut line = vec![T::ZERO; self.old[1]];
        let mut run = move |is_back, (from, to): (&[T], &mut [T])| {
            let (map, line) = (self, &mut line[..]);
            pulp::Arch::new().dispatch(Channel {
                map,
                is_back,
                from,
                line,
                to,
            });
        };
        let channels = inputs[0].chunks_exact(old_area).zip(output.chunks_exact_mut(area));
        channels.for_each(|channel| run(false, channel));
        let back = move |gradient: Vec<T>, sums: &mut Sums<T>| {
            let image = sums.sum_mut(0, self.channels * old_area);
            let channels = gradient.chunks_exact(area).zip(image.chunks_exact_mut(old_area));
            channels.for_each(|channel| run(true, channel));
        };
        (Arc::new(output), keeps.then(|| Box::new(back) as Back<T>))
    }
}
