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
    pub(crate) fn new(channels: usize, old: [usize; 2], weights: [&[f32]; 2]) -> Self {
        let axis = |i: usize| -> Axis {
            let nonzero = |row: &[f32]| {
                row.iter()
                    .copied()
                    .enumerate()
                    .filter(|(_, weight)| *weight != 0.0)
                    .collect()
            };
            weights[i].chunks_exact(old[i]).map(nonzero).collect()
        };
        Separate {
            channels,
            old,
            rows: axis(0),
            columns: axis(1),
        }
    }

    fn old_area(&self) -> usize {
        self.old.iter().product()
    }

    fn area(&self) -> usize {
        self.rows.len() * self.columns.len()
    }

    fn run(&self, way: Way, from: &[f32], line: &mut [f32], to: &mut [f32]) {
        let map = self;
        pulp::Arch::new().dispatch(Channel {
            map,
            way,
            from,
            line,
            to,
        });
    }

    #[inline(always)]
    fn channel(&self, from: &[f32], line: &mut [f32], to: &mut [f32]) {
        for (to, row) in to.chunks_exact_mut(self.columns.len()).zip(&self.rows) {
            line.fill(0.0);
            for (y, weight) in row {
                let from = &from[y * self.old[1]..][..line.len()];
                line.iter_mut()
                    .zip(from)
                    .for_each(|(sum, v)| *sum = v.mul_add(*weight, *sum));
            }
            for (to, column) in to.iter_mut().zip(&self.columns) {
                *to = column
                    .iter()
                    .fold(0.0, |sum, (x, weight)| line[*x].mul_add(*weight, sum));
            }
        }
    }

    /// The transpose of [`Separate::channel`].
    #[inline(always)]
    fn channel_back(&self, gradient: &[f32], line: &mut [f32], to: &mut [f32]) {
        for (gradient, row) in gradient.chunks_exact(self.columns.len()).zip(&self.rows) {
            line.fill(0.0);
            for (g, column) in gradient.iter().zip(&self.columns) {
                column
                    .iter()
                    .for_each(|(x, weight)| line[*x] = g.mul_add(*weight, line[*x]));
            }
            for (y, weight) in row {
                let to = &mut to[y * self.old[1]..][..line.len()];
                to.iter_mut()
                    .zip(line.iter())
                    .for_each(|(to, g)| *to = g.mul_add(*weight, *to));
            }
        }
    }
}

enum Way {
    There,
    Back,
}

/// One channel, by way of a line of old columns.
struct Channel<'a> {
    map: &'a Separate,
    way: Way,
    from: &'a [f32],
    line: &'a mut [f32],
    to: &'a mut [f32],
}

impl pulp::WithSimd for Channel<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        match self.way {
            Way::There => self.map.channel(self.from, self.line, self.to),
            Way::Back => self.map.channel_back(self.from, self.line, self.to),
        }
    }
}

impl Layer for Separate {
    fn forward(&self, inputs: Vec<Array>, keeps: bool) -> (Array, Option<Back<'_>>) {
        let mut output = vec![0.0; self.channels * self.area()];
        let mut line = vec![0.0; self.old[1]];
        let channels = inputs[0]
            .chunks_exact(self.old_area())
            .zip(output.chunks_exact_mut(self.area()));
        channels.for_each(|(from, to)| self.run(Way::There, from, &mut line, to));
        let back = move |gradient: Vec<f32>, sums: &mut Sums| {
            let image = sums.of(0, self.channels * self.old_area());
            let channels = gradient
                .chunks_exact(self.area())
                .zip(image.chunks_exact_mut(self.old_area()));
            channels.for_each(|(gradient, to)| self.run(Way::Back, gradient, &mut line, to));
        };
        (Arc::new(output), keeps.then(|| Box::new(back) as Back))
    }
}
