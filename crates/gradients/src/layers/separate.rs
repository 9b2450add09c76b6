//! Linear maps of each channel that treat rows and columns apart: resizing, averages, borders of zeros.

use std::sync::Arc;

use super::{Array, Back, Layer, Sums};

/// For each new index of an axis, the old ones that it is made of, with their weights.
type Axis = Vec<Vec<(usize, f32)>>;

pub(crate) struct Separate {
    channels: usize,
    old: [usize; 2],
    rows: Axis,
    columns: Axis,
}

impl Separate {
    /// `weights`: of rows and of columns, new × old, row-major.
    pub(crate) fn new(channels: usize, old: [usize; 2], weights: [Vec<f32>; 2]) -> Self {
        let [rows, columns] = [0, 1].map(|i| -> Axis {
            let nonzero = |row: &[f32]| {
                let weights = row.iter().copied().enumerate();
                weights.filter(|(_, weight)| *weight != 0.0).collect()
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
    fn channel(&self, from: &[f32], line: &mut [f32], to: &mut [f32]) {
        for (to, row) in to.chunks_exact_mut(self.columns.len()).zip(&self.rows) {
            line.fill(0.0);
            for (y, weight) in row {
                let from = &from[y * self.old[1]..][..line.len()];
                (line.iter_mut().zip(from)).for_each(|(sum, v)| *sum = v.mul_add(*weight, *sum));
            }
            for (to, column) in to.iter_mut().zip(&self.columns) {
                *to = (column.iter()).fold(0.0, |sum, (x, weight)| line[*x].mul_add(*weight, sum));
            }
        }
    }

    /// The transpose of [`Separate::channel`].
    #[inline(always)]
    fn channel_back(&self, gradient: &[f32], line: &mut [f32], to: &mut [f32]) {
        for (gradient, row) in gradient.chunks_exact(self.columns.len()).zip(&self.rows) {
            line.fill(0.0);
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
struct Channel<'a> {
    map: &'a Separate,
    is_back: bool,
    from: &'a [f32],
    line: &'a mut [f32],
    to: &'a mut [f32],
}

impl pulp::WithSimd for Channel<'_> {
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

impl Layer for Separate {
    fn forward(&self, inputs: Vec<Array>, keeps: bool) -> (Array, Option<Back<'_>>) {
        let (old_area, area) = (self.old.iter().product(), self.rows.len() * self.columns.len());
        let mut output = vec![0.0; self.channels * area];
        let mut line = vec![0.0; self.old[1]];
        let mut run = move |is_back, (from, to): (&[f32], &mut [f32])| {
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
        let back = move |gradient: Vec<f32>, sums: &mut Sums| {
            let image = sums.sum_mut(0, self.channels * old_area);
            let channels = gradient.chunks_exact(area).zip(image.chunks_exact_mut(old_area));
            channels.for_each(|channel| run(true, channel));
        };
        (Arc::new(output), keeps.then(|| Box::new(back) as Back))
    }
}
