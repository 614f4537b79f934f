//! Discrete cosine transforms of many columns at once, and the power of blocks by frequency.

use crate::Real;
use crate::simd::multiversion;
use std::f64::consts::{PI, TAU};

/// Columns side by side in a vector: of float64 they fill a cache line.
const LANES: usize = 8;

/// Columns that are transformed together, the second half as imaginary parts of the first.
pub(super) const BATCH: usize = 2 * LANES;

/// What goes through the stages of a transform: real and imaginary parts of [`LANES`] numbers.
type Row<T> = [[T; LANES]; 2];

/// Cosine transforms (type II, orthonormal) of columns of one length, a power of two, and the way back.
#[derive(Debug, Clone)]
pub(super) struct Transform {
    block: usize,
    /// Each number with its bits reversed.
    reversed: Vec<usize>,
    /// The order in which frames go through a Fourier transform: even ones from the front, odd ones from the back.
    positions: Vec<usize>,
    /// `cos`, `sin` of `−2πk/block`, for the first half.
    turns: Vec<[f64; 2]>,
    /// `cos`, `sin` of `−πk/2·block`, scaled.
    halves: Vec<[f64; 2]>,
    rows: Vec<Row<f64>>,
}

impl Transform {
    pub(super) fn new(block: usize) -> Self {
        let bits = block.trailing_zeros();
        let reversed = |i: usize| if bits == 0 { 0 } else { i.reverse_bits() >> (usize::BITS - bits) };
        let position = |frame: usize| if frame.is_multiple_of(2) { frame / 2 } else { block - 1 - frame / 2 };
        let angle = |angle: f64, scale: f64| {
            let (sin, cos) = Real::sin_cos(angle);
            [cos * scale, -sin * scale]
        };
        let length = block as f64;
        let turns = (0..block / 2).map(|k| angle(TAU * k as f64 / length, 1.0)).collect();
        let halves = (0..block)
            .map(|k| angle(PI * k as f64 / (2.0 * length), (if k == 0 { 1.0 } else { 2.0 } / length).sqrt()))
            .collect();
        Self {
            block,
            reversed: (0..block).map(reversed).collect(),
            positions: (0..block).map(position).collect(),
            turns,
            halves,
            rows: vec![[[0.0; LANES]; 2]; block],
        }
    }

    /// Puts cosine transforms in the place of [`BATCH`] columns of rows of `width` numbers, from the column `first` on.
    pub(super) fn forth(&mut self, columns: &mut [f64], width: usize, first: usize) {
        for (&position, row) in self.positions.iter().zip(columns.chunks_exact(width)) {
            let (re, im) = row[first..first + BATCH].split_at(LANES);
            let to = &mut self.rows[self.reversed[position]];
            to[0].copy_from_slice(re);
            to[1].copy_from_slice(im);
        }
        butterflies(&mut self.rows, &self.turns);
        for (k, (row, half)) in columns.chunks_exact_mut(width).zip(&self.halves).enumerate() {
            let [re, im] = cosines(&self.rows, k, *half);
            row[first..first + LANES].copy_from_slice(&re);
            row[first + LANES..first + BATCH].copy_from_slice(&im);
        }
    }

    /// Puts columns in the place of their cosine transforms.
    pub(super) fn back(&mut self, columns: &mut [f64], width: usize, first: usize) {
        for (k, [cos, sin]) in self.halves.iter().enumerate() {
            let here = &columns[k * width + first..][..BATCH];
            // Of the transform `c` of a column, `(c_k − i c_{n−k}) e^{iπk/2n}` is its Fourier transform but for a factor; `c_n` is 0.
            let mirrored = &columns[(self.block - k) % self.block * width + first..][..BATCH];
            let (share, beside) = if k == 0 { (1.0, 0.0) } else { (0.5, 0.5) };
            let (mut re, mut im) = ([0.0; LANES], [0.0; LANES]);
            for i in 0..LANES {
                let (a, b) = (here[i] * share, mirrored[i] * beside);
                let (c, d) = (here[LANES + i] * share, mirrored[LANES + i] * beside);
                re[i] = (cos * a - sin * b) + (sin * c + cos * d);
                im[i] = (cos * c - sin * d) - (sin * a + cos * b);
            }
            // With real and imaginary parts in each other's place the transform is its own inverse.
            self.rows[self.reversed[k]] = [im, re];
        }
        butterflies(&mut self.rows, &self.turns);
        for (&position, row) in self.positions.iter().zip(columns.chunks_exact_mut(width)) {
            let [im, re] = &self.rows[position];
            row[first..first + LANES].copy_from_slice(re);
            row[first + LANES..first + BATCH].copy_from_slice(im);
        }
    }

    /// Squares of the transforms of up to [`BATCH`] blocks of `z` without their means, one row for each frequency.
    pub(super) fn powers(&mut self, z: &[f64], starts: &[usize], powers: &mut [[f64; BATCH]]) {
        let block = self.block;
        for (lane, &start) in starts.iter().enumerate() {
            let z = &z[start..start + block];
            let mean = sum(z) / block as f64;
            for (&position, z) in self.positions.iter().zip(z) {
                self.rows[self.reversed[position]][lane / LANES][lane % LANES] = z - mean;
            }
        }
        butterflies(&mut self.rows, &self.turns);
        squares(&self.rows, &self.halves, powers);
    }
}

/// A sum, of several sums side by side.
fn sum(numbers: &[f64]) -> f64 {
    let (rows, rest) = numbers.as_chunks::<LANES>();
    let mut sums = [0.0; LANES];
    for row in rows {
        for i in 0..LANES {
            sums[i] += row[i];
        }
    }
    sums.iter().chain(rest).sum()
}

/// The stages of a fast Fourier transform, of rows in the order of reversed bits.
fn butterflies(rows: &mut [Row<f64>], turns: &[[f64; 2]]) {
    let block = rows.len();
    let mut half = 1;
    while half < block {
        stage(rows, turns, half);
        half *= 2;
    }
}

multiversion! {
    /// Puts pairs of transforms of `half` numbers together.
    fn stage<T: Real>(rows: &mut [Row<T>], turns: &[[T; 2]], half: usize) {
        let stride = turns.len() / half;
        for pair in rows.chunks_exact_mut(2 * half) {
            let (first, second) = pair.split_at_mut(half);
            for ((a, b), turn) in first.iter_mut().zip(second).zip(turns.iter().step_by(stride)) {
                let [cos, sin] = *turn;
                for i in 0..LANES {
                    let (re, im) = (b[0][i] * cos - b[1][i] * sin, b[0][i] * sin + b[1][i] * cos);
                    let (x, y) = (a[0][i], a[1][i]);
                    a[0][i] = x + re;
                    a[1][i] = y + im;
                    b[0][i] = x - re;
                    b[1][i] = y - im;
                }
            }
        }
    }
}

/// The numbers `k` of the cosine transforms of the columns that went in as real and as imaginary parts.
#[inline(always)]
fn cosines(rows: &[Row<f64>], k: usize, [cos, sin]: [f64; 2]) -> Row<f64> {
    let (a, b) = (&rows[k], &rows[(rows.len() - k) % rows.len()]);
    let mut numbers = [[0.0; LANES]; 2];
    for i in 0..LANES {
        // Transforms of real numbers: their values at k and −k are conjugate.
        let (re, im) = (0.5 * (a[0][i] + b[0][i]), 0.5 * (a[1][i] - b[1][i]));
        numbers[0][i] = re * cos - im * sin;
        let (re, im) = (0.5 * (a[1][i] + b[1][i]), 0.5 * (b[0][i] - a[0][i]));
        numbers[1][i] = re * cos - im * sin;
    }
    numbers
}

/// Squares of the cosine transforms.
fn squares(rows: &[Row<f64>], halves: &[[f64; 2]], powers: &mut [[f64; BATCH]]) {
    for (k, (power, half)) in powers.iter_mut().zip(halves).enumerate() {
        let numbers = cosines(rows, k, *half);
        for (power, number) in power.iter_mut().zip(numbers.iter().flatten()) {
            *power = number * number;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_are_those_of_the_sum_of_cosines() {
        for block in [2_usize, 8, 64] {
            let z: Vec<f64> = (0..block + 20).map(|t| ((t * t * 7) % 23) as f64).collect();
            let starts: Vec<usize> = (0..BATCH).collect();
            let mut powers = vec![[0.0; BATCH]; block];
            Transform::new(block).powers(&z, &starts, &mut powers);
            for (lane, start) in starts.into_iter().enumerate() {
                let part = &z[start..start + block];
                let mean = part.iter().sum::<f64>() / block as f64;
                for (k, powers) in powers.iter().enumerate() {
                    let term = |n: usize| {
                        let (_, cos) = Real::sin_cos(PI * k as f64 * (2 * n + 1) as f64 / (2 * block) as f64);
                        (part[n] - mean) * cos
                    };
                    let sum = (0..block).map(term).sum::<f64>();
                    let expected = sum * sum * if k == 0 { 1.0 } else { 2.0 } / block as f64;
                    assert!((powers[lane] - expected).abs() < 1e-9, "{block} {lane} {k}");
                }
            }
        }
    }

    #[test]
    fn transforms_are_orthonormal_sums_of_cosines_and_go_back() {
        for block in [2_usize, 8, 64] {
            let width = 2 * BATCH;
            let columns: Vec<f64> = (0..block * width).map(|at| ((at * at * 7) % 23) as f64).collect();
            let mut transform = Transform::new(block);
            let mut found = columns.clone();
            transform.forth(&mut found, width, BATCH);
            for k in 0..block {
                let scale = (if k == 0 { 1.0 } else { 2.0 } / block as f64).sqrt();
                for column in 0..width {
                    let term = |n: usize| {
                        let angle = PI * k as f64 * (2 * n + 1) as f64 / (2 * block) as f64;
                        columns[n * width + column] * Real::sin_cos(angle).1
                    };
                    let sum = scale * (0..block).map(term).sum::<f64>();
                    let expected = if column < BATCH { columns[k * width + column] } else { sum };
                    assert!((found[k * width + column] - expected).abs() < 1e-10);
                }
            }
            transform.back(&mut found, width, BATCH);
            for (x, y) in found.iter().zip(&columns) {
                assert!((x - y).abs() < 1e-11);
            }
        }
    }
}
