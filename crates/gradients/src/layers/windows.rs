//! Windows on an image, and the weights of the numbers in them.

use super::Number;

/// Windows on an image; rows first.
#[derive(Debug, Clone, Copy)]
pub struct Windows {
    pub channels: usize,
    pub image: [usize; 2],
    pub kernel: [usize; 2],
    pub stride: [usize; 2],
    pub dilation: [usize; 2],
    /// Rows above, columns on the left that the image is enlarged by.
    pub before: [usize; 2],
    pub count: [usize; 2],
}

impl Windows {
    pub(super) fn image_area(&self) -> usize {
        self.image.iter().product()
    }

    pub(super) fn area(&self) -> usize {
        self.count.iter().product()
    }

    /// The numbers of a window in one channel.
    pub(super) fn taps(&self) -> usize {
        self.kernel.iter().product()
    }

    /// Returns where the number `tap` of window `at` lies along an axis, if it lies on the image.
    pub fn place(&self, axis: usize, at: usize, tap: usize) -> Option<usize> {
        let place = (at * self.stride[axis] + tap * self.dilation[axis]).checked_sub(self.before[axis])?;
        (place < self.image[axis]).then_some(place)
    }

    /// Numbers of an image's row that windows beside each other have at the same place.
    #[inline]
    pub(super) fn gather<T: Number>(&self, row: &[T], to: &mut [T]) {
        match self.stride[1] {
            1 => to.copy_from_slice(&row[..to.len()]),
            step => (to.iter_mut().zip(row.iter().step_by(step))).for_each(|(to, from)| *to = *from),
        }
    }

    /// The transpose of [`Windows::gather`].
    #[inline]
    pub(super) fn scatter<T: Number>(&self, from: &[T], row: &mut [T]) {
        let to = row.iter_mut().step_by(self.stride[1]);
        to.zip(from).for_each(|(to, from)| *to += *from);
    }

    /// The windows along an axis whose number `tap` lies on the image, and where that of the first lies.
    pub(super) fn inside(&self, axis: usize, tap: usize) -> (std::ops::Range<usize>, usize) {
        let at = tap * self.dilation[axis];
        let first = self.before[axis].saturating_sub(at).div_ceil(self.stride[axis]);
        let end = (self.image[axis] + self.before[axis])
            .saturating_sub(at)
            .div_ceil(self.stride[axis])
            .min(self.count[axis]);
        let place = (first * self.stride[axis] + at).saturating_sub(self.before[axis]);
        (first.min(end)..end, place)
    }
}

/// Weights (outputs × channels of a group × kernel) and biases.
pub struct Weights<T = f32> {
    pub groups: usize,
    pub weights: Vec<T>,
    pub biases: Option<Vec<T>>,
    /// Output channels.
    pub outputs: usize,
}

impl<T: Number> Weights<T> {
    /// The bias of each output channel, once for each of so many places.
    pub(super) fn biases_each(&self, area: usize) -> Vec<T> {
        let mut output = Vec::with_capacity(self.outputs * area);
        for channel in 0..self.outputs {
            output.resize((channel + 1) * area, self.bias(channel));
        }
        output
    }

    pub(super) fn bias(&self, output: usize) -> T {
        self.biases.as_ref().map_or(T::ZERO, |biases| biases[output])
    }
}
