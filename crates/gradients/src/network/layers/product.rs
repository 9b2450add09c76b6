//! Products of matrices.

use gemm::{Parallelism, gemm};

/// Numbers read as a matrix: by how many numbers a row and a column lie apart.
#[derive(Clone, Copy)]
pub(super) struct Matrix<'a> {
    pub numbers: &'a [f32],
    pub steps: [usize; 2],
}

impl<'a> Matrix<'a> {
    pub(super) fn rows(numbers: &'a [f32], columns: usize) -> Self {
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
pub(super) fn multiply(
    (sum, row_step, adds): (&mut [f32], usize, bool),
    a: Matrix,
    b: Matrix,
    [rows, columns, inner]: [usize; 3],
) {
    if rows == 0 || columns == 0 || inner == 0 {
        return;
    }
    let to = Matrix::rows(sum, row_step);
    assert!(row_step >= columns && to.holds([rows, columns]) && a.holds([rows, inner]) && b.holds([inner, columns]));
    let [a_steps, b_steps] = [a, b].map(|m| m.steps.map(|step| step as isize));
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
            1.0,
            1.0,
            false,
            false,
            false,
            Parallelism::None,
        );
    }
}
