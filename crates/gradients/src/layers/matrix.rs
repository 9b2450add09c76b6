//! Products of matrices.

use std::sync::Arc;

use gemm::{Parallelism, gemm};

use super::{Array, Back, Layer, Number, Sums};

/// Numbers read as a matrix: by how many numbers a row and a column lie apart.
pub(super) struct Matrix<'a, T> {
    numbers: &'a [T],
    steps: [usize; 2],
}

impl<'a, T> Matrix<'a, T> {
    pub(super) fn rows(numbers: &'a [T], columns: usize) -> Self {
        let steps = [columns, 1];
        Matrix { numbers, steps }
    }

    pub(super) fn transposed(self) -> Self {
        let steps = [self.steps[1], self.steps[0]];
        Matrix { steps, ..self }
    }

    fn holds(&self, [rows, columns]: [usize; 2]) -> bool {
        let last = (rows - 1) * self.steps[0] + (columns - 1) * self.steps[1];
        last < self.numbers.len()
    }
}

/// Adds a·b to `sum`, whose rows lie `row_step` apart, or writes it there where `sum` holds nothing yet. `sides`: the rows of a, the
/// columns of b, and the columns of a.
pub(super) fn multiply<T: Number>(
    (sum, row_step, adds): (&mut [T], usize, bool),
    a: Matrix<T>,
    b: Matrix<T>,
    [rows, columns, inner]: [usize; 3],
) {
    if rows == 0 || columns == 0 || inner == 0 {
        return;
    }
    let to = Matrix::rows(sum, row_step);
    assert!(row_step >= columns && to.holds([rows, columns]) && a.holds([rows, inner]) && b.holds([inner, columns]));
    let [a_steps, b_steps] = [a.steps, b.steps].map(|steps| steps.map(|step| step as isize));
    // SAFETY: the largest index of each matrix was held against its length, and rows of `sum` do not overlap.
    unsafe {
        gemm(
            rows,
            columns,
            inner,
            sum.as_mut_ptr(),
            1,
            row_step as isize,
            adds,
            a.numbers.as_ptr(),
            a_steps[1],
            a_steps[0],
            b.numbers.as_ptr(),
            b_steps[1],
            b_steps[0],
            T::ONE,
            T::ONE,
            false,
            false,
            false,
            Parallelism::None,
        );
    }
}

/// Stacks of matrices multiplied one with one; either stack may be a constant.
pub struct Product<T = f32> {
    /// In place of the first stack or of the second.
    pub constants: [Option<Array<T>>; 2],
    /// For each product, which matrix of either stack.
    pub pairs: Vec<[usize; 2]>,
    /// The rows of the first, the columns of the second, and the columns of the first.
    pub sides: [usize; 3],
    /// True for stacks whose matrices are stored transposed.
    pub turned: [bool; 2],
}

impl<T: Number> Product<T> {
    /// Numbers of one matrix of the result, of the first and of the second stack.
    fn sizes(&self) -> [usize; 3] {
        let [rows, columns, inner] = self.sides;
        [rows * columns, rows * inner, inner * columns]
    }

    fn matrix<'a>(&self, numbers: &'a [T], which: usize, at: usize) -> Matrix<'a, T> {
        let ([rows, columns, inner], size) = (self.sides, self.sizes()[1 + which]);
        let [rows, columns] = [[rows, inner], [inner, columns]][which];
        let numbers = &numbers[at * size..][..size];
        if self.turned[which] {
            Matrix::rows(numbers, rows).transposed()
        } else {
            Matrix::rows(numbers, columns)
        }
    }

    /// Adds the derivative by one of the stacks, `other` being the other one's numbers.
    fn back(&self, which: usize, gradient: &[T], other: &[T], sum: &mut [T]) {
        let [rows, columns, inner] = self.sides;
        let sizes = self.sizes();
        for (gradient, pair) in gradient.chunks_exact(sizes[0]).zip(&self.pairs) {
            let g = Matrix::rows(gradient, columns);
            let other = self.matrix(other, 1 - which, pair[1 - which]).transposed();
            let sum = &mut sum[pair[which] * sizes[1 + which]..];
            match (which, self.turned[which]) {
                (0, false) => multiply((sum, inner, true), g, other, [rows, inner, columns]),
                (0, true) => multiply(
                    (sum, rows, true),
                    other.transposed(),
                    g.transposed(),
                    [inner, rows, columns],
                ),
                (_, false) => multiply((sum, columns, true), other, g, [inner, columns, rows]),
                (_, true) => multiply(
                    (sum, inner, true),
                    g.transposed(),
                    other.transposed(),
                    [columns, inner, rows],
                ),
            }
        }
    }
}

impl<T: Number> Layer<T> for Product<T> {
    fn forward(&self, inputs: Vec<Array<T>>, keeps: bool) -> (Array<T>, Option<Back<'_, T>>) {
        let mut inputs = inputs.into_iter();
        let stacks = self.constants.each_ref().map(|constant| match constant {
            Some(constant) => constant.clone(),
            None => inputs.next().unwrap_or_default(),
        });
        let size = self.sizes()[0];
        let mut result = vec![T::ZERO; self.pairs.len() * size];
        for (sum, pair) in result.chunks_exact_mut(size).zip(&self.pairs) {
            let [a, b] = [0, 1].map(|which| self.matrix(&stacks[which], which, pair[which]));
            multiply((sum, self.sides[1], false), a, b, self.sides);
        }
        // Of a constant no derivative is needed, nor what would be multiplied with for it.
        let kept = [0, 1].map(|which| match self.constants[1 - which] {
            Some(_) => Array::default(),
            None => stacks[which].clone(),
        });
        let back = move |gradient: Vec<T>, sums: &mut Sums<T>| {
            let mut input = 0;
            for (which, constant) in self.constants.iter().enumerate() {
                if constant.is_none() {
                    let other = self.constants[1 - which].as_ref().unwrap_or(&kept[1 - which]);
                    let count = stack_size(&self.pairs, which) * self.sizes()[1 + which];
                    self.back(which, &gradient, other, sums.sum_mut(input, count));
                    input += 1;
                }
            }
        };
        (Arc::new(result), keeps.then(|| Box::new(back) as Back<T>))
    }
}

/// Matrices in one of the stacks.
fn stack_size(pairs: &[[usize; 2]], which: usize) -> usize {
    pairs.iter().map(|pair| pair[which] + 1).max().unwrap_or(0)
}
