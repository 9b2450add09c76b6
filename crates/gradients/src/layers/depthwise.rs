//! Convolutions of each channel by itself.

use std::sync::Arc;

use super::windows::{Weights, Windows};
use super::{Array, Back, Layer, Number, Sums};

/// Windows that are summed at a time.
const LANES: usize = 16;

pub(super) struct Depthwise<T> {
    pub windows: Windows,
    pub weights: Weights<T>,
}

/// One channel with its border, as windows meet it: of a stride of 2, even columns of a row come before its odd ones, so that the numbers
/// which neighbouring windows have at the same place lie beside each other.
struct Plane<'a> {
    windows: &'a Windows,
    rows: usize,
    /// Numbers of one phase of a row.
    width: usize,
    /// Places of the numbers of a row's first window, counted from where the row begins.
    taps: Vec<usize>,
}

impl<'a> Plane<'a> {
    fn new(windows: &'a Windows) -> Self {
        let reach = |axis: usize| {
            (windows.count[axis] - 1) * windows.stride[axis] + (windows.kernel[axis] - 1) * windows.dilation[axis] + 1
        };
        let (w, width) = (windows, reach(1).div_ceil(windows.stride[1]) + LANES);
        let places = (0..w.taps()).map(|tap| [tap / w.kernel[1] * w.dilation[0], tap % w.kernel[1] * w.dilation[1]]);
        let taps = places.map(|[y, x]| (y * w.stride[1] + x % w.stride[1]) * width + x / w.stride[1]);
        Plane {
            windows,
            rows: reach(0),
            width,
            taps: taps.collect(),
        }
    }

    fn size(&self) -> usize {
        self.rows * self.row()
    }

    fn row(&self) -> usize {
        self.windows.stride[1] * self.width
    }

    /// Calls back for each row of the image that windows meet, and each phase of it: where it begins in the image, where here, and how many
    /// numbers it has there.
    fn each_line(&self, mut line: impl FnMut(usize, usize, usize)) {
        let (w, step) = (self.windows, self.windows.stride[1]);
        let columns = w.image[1].min((self.row() - LANES * step).saturating_sub(w.before[1]));
        for y in 0..w.image[0].min(self.rows.saturating_sub(w.before[0])) {
            for phase in 0..step.min(columns) {
                let (at, count) = (phase + w.before[1], (columns - phase).div_ceil(step));
                let here = (y + w.before[0]) * self.row() + at % step * self.width + at / step;
                line(y * w.image[1] + phase, here, count);
            }
        }
    }

    fn take<T: Number>(&self, channel: &[T], plane: &mut [T]) {
        self.each_line(|from, to, count| self.windows.gather(&channel[from..], &mut plane[to..to + count]));
    }

    fn add_to<T: Number>(&self, plane: &[T], channel: &mut [T]) {
        self.each_line(|to, from, count| self.windows.scatter(&plane[from..from + count], &mut channel[to..]));
    }
}

impl<T: Number> Depthwise<T> {
    fn kernel(&self, channel: usize) -> &[T] {
        &self.weights.weights[channel * self.windows.taps()..][..self.windows.taps()]
    }

    fn run(&self, plane: &Plane, channel: usize, numbers: &mut [T], work: Work<T>) {
        let weights = self.kernel(channel).iter().copied();
        let taps: Vec<(usize, T)> = plane.taps.iter().copied().zip(weights).collect();
        pulp::Arch::new().dispatch(Rows {
            plane,
            taps: &taps,
            bias: self.weights.bias(channel),
            numbers,
            work,
        });
    }

    fn back(&self, gradient: &[T], sums: &mut Sums<T>) {
        let w = &self.windows;
        let image = sums.sum_mut(0, w.channels * w.image_area());
        let plane = Plane::new(w);
        let mut numbers = vec![T::ZERO; plane.size()];
        for channel in 0..w.channels {
            let gradient = &gradient[channel * w.area()..][..w.area()];
            if gradient.iter().all(|g| *g == T::ZERO) {
                continue;
            }
            numbers.fill(T::ZERO);
            self.run(&plane, channel, &mut numbers, Work::Spread(gradient));
            plane.add_to(&numbers, &mut image[channel * w.image_area()..][..w.image_area()]);
        }
    }
}

/// The work on one channel, compiled for this processor's vectors. (A closure as large as this is not.)
struct Rows<'a, T> {
    plane: &'a Plane<'a>,
    taps: &'a [(usize, T)],
    bias: T,
    numbers: &'a mut [T],
    work: Work<'a, T>,
}

enum Work<'a, T> {
    /// The windows' sums are written here.
    Gather(&'a mut [T]),
    /// The transpose of it, from derivatives by these sums.
    Spread(&'a [T]),
}

impl<T: Number> pulp::WithSimd for Rows<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let columns = self.plane.windows.count[1];
        let row = self.plane.windows.stride[0] * self.plane.row();
        match self.work {
            Work::Gather(sums) => {
                for (i, sums) in sums.chunks_exact_mut(columns).enumerate() {
                    gather(sums, self.bias, &self.numbers[i * row..], self.taps);
                }
            }
            Work::Spread(gradient) => {
                for (i, gradient) in gradient.chunks_exact(columns).enumerate() {
                    spread(gradient, self.taps, &mut self.numbers[i * row..]);
                }
            }
        }
    }
}

#[inline(always)]
fn gather<T: Number>(sums: &mut [T], bias: T, numbers: &[T], taps: &[(usize, T)]) {
    for (block, sums) in sums.chunks_mut(LANES).enumerate() {
        let mut lanes = [bias; LANES];
        for (at, weight) in taps {
            let numbers = &numbers[at + block * LANES..][..LANES];
            (lanes.iter_mut().zip(numbers)).for_each(|(sum, number)| *sum = number.mul_add(*weight, *sum));
        }
        sums.copy_from_slice(&lanes[..sums.len()]);
    }
}

/// The transpose of [`gather`].
#[inline(always)]
fn spread<T: Number>(gradient: &[T], taps: &[(usize, T)], numbers: &mut [T]) {
    for (at, weight) in taps {
        let numbers = &mut numbers[*at..][..gradient.len()];
        (numbers.iter_mut().zip(gradient)).for_each(|(number, g)| *number = g.mul_add(*weight, *number));
    }
}

impl<T: Number> Layer<T> for Depthwise<T> {
    fn forward(&self, inputs: Vec<Array<T>>, keeps: bool) -> (Array<T>, Option<Back<'_, T>>) {
        let (w, image) = (&self.windows, &inputs[0]);
        let plane = Plane::new(w);
        let mut numbers = vec![T::ZERO; plane.size()];
        let mut output = vec![T::ZERO; w.channels * w.area()];
        for (channel, output) in output.chunks_exact_mut(w.area()).enumerate() {
            plane.take(&image[channel * w.image_area()..][..w.image_area()], &mut numbers);
            self.run(&plane, channel, &mut numbers, Work::Gather(output));
        }
        let back = |gradient: Vec<T>, sums: &mut Sums<T>| self.back(&gradient, sums);
        (Arc::new(output), keeps.then(|| Box::new(back) as Back<T>))
    }
}
