//! Small dense matrices: rows are padded with zeros to whole lanes, and sums have a fixed order.

use super::LANE;
use crate::Error;
use crate::clip::Planes;
use crate::parallel::Interrupt;
use crate::simd::multiversion;

/// Rows whose sums stay in registers together.
const PAIR: usize = 2;

/// Rows that are multiplied with each other while they are in the first-level cache.
const TOGETHER: usize = 32;

/// A row-major matrix with rows padded to whole lanes.
#[derive(Debug)]
pub(super) struct Matrix {
    data: Planes<f64>,
    width: usize,
    columns: usize,
}

impl Matrix {
    pub(super) fn new(rows: usize, columns: usize) -> Self {
        let width = columns.next_multiple_of(LANE);
        Self { data: Planes::new(1, rows * width), width, columns }
    }

    /// Length of a padded row.
    pub(super) fn width(&self) -> usize {
        self.width
    }

    pub(super) fn columns(&self) -> usize {
        self.columns
    }

    pub(super) fn data(&self) -> &[f64] {
        self.data.row(0)
    }

    pub(super) fn data_mut(&mut self) -> &mut [f64] {
        self.data.row_mut(0)
    }

    /// All rows, padded.
    pub(super) fn rows(&self) -> std::slice::ChunksExact<'_, f64> {
        self.data().chunks_exact(self.width)
    }

    pub(super) fn rows_mut(&mut self) -> std::slice::ChunksExactMut<'_, f64> {
        let width = self.width;
        self.data_mut().chunks_exact_mut(width)
    }

    pub(super) fn at(&self, row: usize, column: usize) -> f64 {
        self.data()[row * self.width + column]
    }

    pub(super) fn set(&mut self, row: usize, column: usize, x: f64) {
        let at = row * self.width + column;
        self.data_mut()[at] = x;
    }

    /// This matrix minus a multiple of another.
    pub(super) fn less(&self, other: &Self, factor: f64) -> Self {
        let mut out = self.copy();
        for (x, y) in out.data_mut().iter_mut().zip(other.data()) {
            *x -= factor * y;
        }
        out
    }

    /// `I − λ A`.
    pub(super) fn hat(&self, ridge: f64) -> Self {
        let mut out = self.copy();
        for x in out.data_mut() {
            *x *= -ridge;
        }
        out.add_to_diagonal(1.0);
        out
    }

    /// The diagonal of the square of a symmetric matrix, padded.
    pub(super) fn square_diagonal(&self) -> Vec<f64> {
        let mut diagonal = vec![0.0; self.width];
        for (x, row) in diagonal.iter_mut().zip(self.rows()) {
            *x = inner(row, row);
        }
        diagonal
    }

    /// The diagonal, padded.
    pub(super) fn diagonal(&self) -> Vec<f64> {
        let mut diagonal = vec![0.0; self.width];
        for (i, x) in diagonal.iter_mut().enumerate().take(self.columns) {
            *x = self.at(i, i);
        }
        diagonal
    }

    pub(super) fn copy(&self) -> Self {
        let mut copy = Self::new(self.data().len() / self.width.max(1), self.columns);
        copy.data_mut().copy_from_slice(self.data());
        copy
    }

    pub(super) fn add_to_diagonal(&mut self, x: f64) {
        let (width, columns) = (self.width, self.columns);
        let data = self.data_mut();
        for i in 0..columns {
            data[i * width + i] += x;
        }
    }

    /// `RᵀR`: the inner products of its columns.
    pub(super) fn gram(&self) -> Self {
        let mut gram = Self::new(self.columns, self.columns);
        // Pairs of rows may extend past the last row, which is padded like the rows themselves.
        let mut square = Planes::new(1, self.width * self.width);
        for rows in self.data().chunks(TOGETHER * self.width) {
            add_products(rows, self.width, square.row_mut(0));
        }
        let square = square.row(0);
        let width = self.width;
        for (i, row) in gram.rows_mut().enumerate() {
            for (j, x) in row.iter_mut().enumerate() {
                *x = square[i.min(j) * width + i.max(j)];
            }
        }
        gram
    }

    /// This matrix times a symmetric matrix.
    pub(super) fn times(&self, symmetric: &Self) -> Self {
        let mut out =
            Self { data: Planes::new(1, self.data().len()), width: self.width, columns: self.columns };
        multiply(self.data(), symmetric.data(), self.width, out.data_mut());
        out
    }

    /// Inverts a symmetric positive definite matrix in place. Such matrices need no pivoting.
    pub(super) fn invert(&mut self, interrupt: &Interrupt) -> Result<(), Error> {
        let (width, columns) = (self.width, self.columns);
        let mut copy = vec![0.0; width];
        for pivot in 0..columns {
            interrupt.check()?;
            eliminate(self.data_mut(), width, pivot, &mut copy);
        }
        Ok(())
    }
}

multiversion! {
    /// Adds the products `Σ_t x_t x_tᵀ` of rows to the upper triangle.
    fn add_products(rows: &[f64], width: usize, matrix: &mut [f64]) {
        for top in (0..width).step_by(PAIR) {
            for left in (top / LANE * LANE..width).step_by(LANE) {
                let mut sums = [[0.0; LANE]; PAIR];
                for row in rows.chunks_exact(width) {
                    let down = [row[top], row[top + 1]];
                    let along = &row[left..left + LANE];
                    for j in 0..LANE {
                        for i in 0..PAIR {
                            sums[i][j] += down[i] * along[j];
                        }
                    }
                }
                for (i, sums) in sums.iter().enumerate() {
                    let to = &mut matrix[(top + i) * width + left..][..LANE];
                    for j in 0..LANE {
                        to[j] += sums[j];
                    }
                }
            }
        }
    }
}

multiversion! {
    /// Each row of `rows` times a matrix.
    fn multiply(rows: &[f64], matrix: &[f64], width: usize, out: &mut [f64]) {
        for (rows, out) in rows.chunks(PAIR * width).zip(out.chunks_mut(PAIR * width)) {
            // With an odd number of rows the last one is computed twice.
            let second = rows.len() - width;
            for left in (0..width).step_by(LANE) {
                let mut sums = [[0.0; LANE]; PAIR];
                for (k, along) in matrix.chunks_exact(width).enumerate() {
                    let along = &along[left..left + LANE];
                    let factors = [rows[k], rows[second + k]];
                    for j in 0..LANE {
                        for i in 0..PAIR {
                            sums[i][j] += factors[i] * along[j];
                        }
                    }
                }
                for (i, sums) in sums.iter().enumerate() {
                    out[i * second + left..][..LANE].copy_from_slice(sums);
                }
            }
        }
    }
}

multiversion! {
    /// One step of Gauss–Jordan elimination in place; `copy` is scratch memory for one row.
    fn eliminate(matrix: &mut [f64], width: usize, pivot: usize, copy: &mut [f64]) {
        let row = &mut matrix[pivot * width..][..width];
        let inverse = 1.0 / row[pivot];
        row[pivot] = 1.0;
        for x in &mut *row {
            *x *= inverse;
        }
        copy.copy_from_slice(row);
        for (k, row) in matrix.chunks_exact_mut(width).enumerate() {
            if k == pivot {
                continue;
            }
            let factor = row[pivot];
            row[pivot] = 0.0;
            for (x, y) in row.iter_mut().zip(&*copy) {
                *x -= factor * y;
            }
        }
    }
}

/// `Σ_k a_k b_k` of padded rows.
#[inline(always)]
pub(super) fn inner(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; LANE];
    for (a, b) in a.chunks_exact(LANE).zip(b.chunks_exact(LANE)) {
        for j in 0..LANE {
            sums[j] += a[j] * b[j];
        }
    }
    halves(sums)
}

/// The sum of a lane, by repeated halving.
#[inline(always)]
pub(super) fn halves(mut sums: [f64; LANE]) -> f64 {
    let mut half = LANE / 2;
    while half > 0 {
        for j in 0..half {
            sums[j] += sums[j + half];
        }
        half /= 2;
    }
    sums[0]
}
