//! Power of blocks by frequency: discrete cosine transforms of many blocks at once.

use crate::Real;
use crate::simd::multiversion;
use std::f64::consts::{PI, TAU};

/// Blocks side by side in a vector: of float64 they fill a cache line.
const LANES: usize = 8;

/// Blocks that are transformed together, the second half as imaginary parts of the first.
pub(super) const BATCH: usize = 2 * LANES;

/// What goes through the stages of a transform: real and imaginary parts of [`LANES`] numbers.
type Row<T> = [[T; LANES]; 2];

/// Cosine transforms (type II, orthonormal) of blocks of one length, a power of two.
#[derive(Debug)]
pub(super) struct Transform {
    block: usize,
    /// Where the frames of a block go: even ones from the front, odd ones from the back, then in the order of reversed bits.
    places: Vec<usize>,
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
        let places = (0..block)
            .map(|frame| reversed(if frame % 2 == 0 { frame / 2 } else { block - 1 - frame / 2 }))
            .collect();
        let angle = |angle: f64, scale: f64| {
            let (sin, cos) = Real::sin_cos(angle);
            [cos * scale, -sin * scale]
        };
        let length = block as f64;
        let turns = (0..block / 2).map(|k| angle(TAU * k as f64 / length, 1.0)).collect();
        let halves = (0..block)
            .map(|k| angle(PI * k as f64 / (2.0 * length), (if k == 0 { 1.0 } else { 2.0 } / length).sqrt()))
            .collect();
        Self { block, places, turns, halves, rows: vec![[[0.0; LANES]; 2]; block] }
    }

    /// Squares of the transforms of up to [`BATCH`] blocks of `z` without their means, one row for each frequency.
    pub(super) fn powers(&mut self, z: &[f64], starts: &[usize], powers: &mut [[f64; BATCH]]) {
        let block = self.block;
        for (lane, &start) in starts.iter().enumerate() {
            let z = &z[start..start + block];
            let mean = z.iter().sum::<f64>() / block as f64;
            for (&place, z) in self.places.iter().zip(z) {
                self.rows[place][lane / LANES][lane % LANES] = z - mean;
            }
        }
        butterflies(&mut self.rows, &self.turns);
        squares(&self.rows, &self.halves, powers);
    }
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

/// Squares of the cosine transforms of the blocks that went in as real and as imaginary parts.
fn squares(rows: &[Row<f64>], halves: &[[f64; 2]], powers: &mut [[f64; BATCH]]) {
    let block = rows.len();
    for (k, (power, [cos, sin])) in powers.iter_mut().zip(halves).enumerate() {
        let (a, b) = (&rows[k], &rows[(block - k) % block]);
        for i in 0..LANES {
            // Transforms of real numbers: their values at k and −k are conjugate.
            let (re, im) = (0.5 * (a[0][i] + b[0][i]), 0.5 * (a[1][i] - b[1][i]));
            let first = re * cos - im * sin;
            let (re, im) = (0.5 * (a[1][i] + b[1][i]), 0.5 * (b[0][i] - a[0][i]));
            let second = re * cos - im * sin;
            power[i] = first * first;
            power[LANES + i] = second * second;
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
}
