//! The largest number of each window.

use std::sync::Arc;

use super::windows::Windows;
use super::{Array, Back, Layer, Number, Sums};

/// First the largest numbers of each window's columns, then the largest of these; of equals the first of the window, row by row.
pub struct MaxPool(pub Windows);

/// The larger of a number and what is largest so far, with its place. What is not a number stays.
#[inline(always)]
fn keep_larger<T: Number>(largest: &mut T, place: &mut u32, number: T, at: u32) {
    let is_larger = number > *largest || (number == *largest && at < *place) || number.is_nan();
    *largest = if is_larger { number } else { *largest };
    *place = if is_larger { at } else { *place };
}

/// One channel on its way to its largest numbers and their places.
struct Channel<'a, T> {
    windows: &'a Windows,
    numbers: &'a [T],
    largest: &'a mut [T],
    places: &'a mut [u32],
}

impl<T: Number> pulp::WithSimd for Channel<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let (w, [_, columns]) = (self.windows, self.windows.image);
        let (mut of_columns, mut their_places) = (vec![T::ZERO; columns], vec![0_u32; columns]);
        let rows = self.largest.chunks_exact_mut(w.count[1]);
        for (row, (largest, places)) in rows.zip(self.places.chunks_exact_mut(w.count[1])).enumerate() {
            of_columns.fill(T::LEAST);
            their_places.fill(u32::MAX);
            for y in (0..w.kernel[0]).filter_map(|tap| w.place(0, row, tap)) {
                let numbers = self.numbers[y * columns..][..columns].iter().copied();
                let to = of_columns.iter_mut().zip(&mut their_places);
                to.zip(numbers.zip((y * columns) as u32..))
                    .for_each(|((largest, place), (number, at))| keep_larger(largest, place, number, at));
            }
            largest.fill(T::LEAST);
            places.fill(u32::MAX);
            for tap in 0..w.kernel[1] {
                let (inside, first) = w.inside(1, tap);
                for (i, at) in inside.enumerate() {
                    let x = first + i * w.stride[1];
                    keep_larger(&mut largest[at], &mut places[at], of_columns[x], their_places[x]);
                }
            }
        }
    }
}

impl<T: Number> Layer<T> for MaxPool {
    fn forward(&self, inputs: Vec<Array<T>>, keeps: bool) -> (Array<T>, Option<Back<'_, T>>) {
        let w = &self.0;
        let count = w.channels * w.area();
        let (mut output, mut places) = (vec![T::ZERO; count], vec![0; count]);
        let channels = inputs[0].chunks_exact(w.image_area());
        let outputs = output.chunks_exact_mut(w.area()).zip(places.chunks_exact_mut(w.area()));
        for (numbers, (largest, places)) in channels.zip(outputs) {
            pulp::Arch::new().dispatch(Channel {
                windows: w,
                numbers,
                largest,
                places,
            });
        }
        let back = move |gradient: Vec<T>, sums: &mut Sums<T>| {
            let image = sums.sum_mut(0, w.channels * w.image_area());
            let channels = image.chunks_exact_mut(w.image_area());
            let gradients = gradient.chunks_exact(w.area()).zip(places.chunks_exact(w.area()));
            for (channel, (gradient, places)) in channels.zip(gradients) {
                for (g, at) in gradient.iter().zip(places) {
                    // A window that lies on the border alone has no number.
                    if let Some(sum) = channel.get_mut(*at as usize) {
                        *sum += *g;
                    }
                }
            }
        };
        (Arc::new(output), keeps.then(|| Box::new(back) as Back<T>))
    }
}
