//! Separable linear maps of images, forward and transposed.

/// Input pixels along one axis that make one output pixel.
#[derive(Debug, Clone)]
pub struct Tap {
    pub first: usize,
    pub weights: Vec<f64>,
}

/// A map of which each output pixel is the weighted sum of a few neighbours along each axis.
#[derive(Debug, Clone)]
pub struct Separable {
    /// Width, height of the image it is given.
    size: [usize; 2],
    columns: Vec<Tap>,
    rows: Vec<Tap>,
}

impl Separable {
    /// Taps of each output column and row, within the image.
    pub fn new(size: [usize; 2], columns: Vec<Tap>, rows: Vec<Tap>) -> Self {
        Self { size, columns, rows }
    }

    /// Columns first, then rows.
    pub fn forward(&self, image: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let width = self.columns.len();
        let mut narrow = Vec::with_capacity(width * self.size[1]);
        for row in image.chunks_exact(self.size[0]) {
            narrow.extend(self.columns.iter().map(|tap| {
                let pixels = row[tap.first..].iter().zip(&tap.weights);
                pixels.fold([0.0; 3], |sum, (rgb, w)| std::array::from_fn(|c| sum[c] + w * rgb[c]))
            }));
        }
        let mut result = vec![[0.0; 3]; width * self.rows.len()];
        for (to, tap) in result.chunks_exact_mut(width).zip(&self.rows) {
            for (row, w) in narrow.chunks_exact(width).skip(tap.first).zip(&tap.weights) {
                add_scaled(to, row, *w);
            }
        }
        result
    }

    /// The transpose of [`Separable::forward`].
    pub fn transposed(&self, result: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let width = self.columns.len();
        let mut narrow = vec![[0.0; 3]; width * self.size[1]];
        for (row, tap) in result.chunks_exact(width).zip(&self.rows) {
            for (to, w) in narrow.chunks_exact_mut(width).skip(tap.first).zip(&tap.weights) {
                add_scaled(to, row, *w);
            }
        }
        let mut image = vec![[0.0; 3]; self.size[0] * self.size[1]];
        for (to, row) in image.chunks_exact_mut(self.size[0]).zip(narrow.chunks_exact(width)) {
            for (tap, rgb) in self.columns.iter().zip(row) {
                for (to, w) in to[tap.first..].iter_mut().zip(&tap.weights) {
                    (0..3).for_each(|c| to[c] += w * rgb[c]);
                }
            }
        }
        image
    }
}

fn add_scaled(to: &mut [[f64; 3]], row: &[[f64; 3]], weight: f64) {
    for (to, rgb) in to.iter_mut().zip(row) {
        (0..3).for_each(|c| to[c] += weight * rgb[c]);
    }
}
