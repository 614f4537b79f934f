//! The powers that the network reads.

use super::basis::Basis;
use super::network::WIDTH;
use super::scales::CellLadder;
use super::{BASES, ESTIMATES, LEAST_NORM, LEAST_POWER, LOGARITHM, OF_REST, OWN_GATES, SCALES};
use crate::clip::Planes;
use crate::elementary::ln;
use crate::simd::multiversion;

/// Scale over cells of the mean power of a basis vector.
const SHORT: [usize; BASES] = per_vector([1, 1, 1, 2, 3, 4, 4], [1, 2, 3]);

/// Scale over cells of its wide mean power.
const WIDE: [usize; BASES] = per_vector([2, 2, 3, 4, 5, 5, 5], [3, 4, 5]);

/// What holds for the vectors of the displacement to the samples and of the pilot, and for those of each estimate.
const fn per_vector(scales: [usize; OF_REST], estimates: [usize; 3]) -> [usize; BASES] {
    let mut result = [0; BASES];
    let mut i = 0;
    while i < BASES {
        result[i] = if i < OF_REST {
            scales[i]
        } else if i < OF_REST + SCALES {
            scales[i - OF_REST]
        } else {
            estimates[(i - OF_REST - SCALES) % (BASES - OF_REST - SCALES).div_euclid(ESTIMATES)]
        };
        i += 1;
    }
    result
}

/// Gates of one joint, planes of cells. Planes are longer than the cells are: the network reads whole blocks.
#[derive(Debug, Default)]
pub(super) struct Gates {
    /// `OWN_GATES` planes for each axis.
    pub(super) own: Planes<f32>,
    /// `BASES` planes.
    pub(super) joint: Planes<f32>,
    power: Vec<f32>,
    ladder: CellLadder,
}

impl Gates {
    /// Room for so many cells, and sums over axes that are 0.
    pub(super) fn reset(&mut self, cells: usize) {
        self.own.reshape(3 * OWN_GATES, cells + WIDTH);
        self.joint.reshape(BASES, cells + WIDTH);
        for vector in 0..BASES {
            self.joint.row_mut(vector).fill(0.0);
        }
        self.power.resize(cells, 0.0);
    }

    /// Takes the powers of one axis; of `frames` frames the last cell may have fewer.
    pub(super) fn take(&mut self, axis: usize, basis: &Basis, frames: usize) {
        let cells = self.power.len();
        let first = axis * OWN_GATES;
        // The short means of the pilot's powers stand where the products with them will.
        let along = first + 3 * BASES;
        for vector in 0..BASES {
            basis.cell_means(vector, vector, frames, &mut self.power);
            self.ladder.climb(&self.power, WIDE[vector]);
            let short = self.ladder.scale(SHORT[vector]);
            logarithms(&self.power, 0.5 * LOGARITHM, self.own.row_mut(first + vector));
            logarithms(short, LOGARITHM, self.own.row_mut(first + BASES + vector));
            logarithms(
                self.ladder.scale(WIDE[vector]),
                LOGARITHM,
                self.own.row_mut(first + 2 * BASES + vector),
            );
            add(short, self.joint.row_mut(vector));
            if (OF_REST..OF_REST + SCALES).contains(&vector) {
                self.own.row_mut(along + vector - OF_REST)[..cells].copy_from_slice(short);
            }
        }
        for (k, &short) in SHORT[..SCALES].iter().enumerate() {
            basis.cell_means(k, OF_REST + k, frames, &mut self.power);
            self.ladder.climb(&self.power, short);
            over_norm(self.ladder.scale(short), self.own.row_mut(along + k));
        }
    }

    /// Makes the sums over axes the gates that they are.
    pub(super) fn close_joint(&mut self) {
        let cells = self.power.len();
        for vector in 0..BASES {
            self.power.copy_from_slice(&self.joint.row(vector)[..cells]);
            logarithms(&self.power, LOGARITHM, self.joint.row_mut(vector));
        }
    }
}

/// Adds the powers of one axis to planes of cells, one for each basis vector.
pub(super) fn add_powers(basis: &Basis, frames: usize, power: &mut Vec<f32>, sums: &mut Planes<f32>) {
    power.resize(sums.length(), 0.0);
    for vector in 0..BASES {
        basis.cell_means(vector, vector, frames, power);
        add(power, sums.row_mut(vector));
    }
}

/// Gates of the body: planes of cells, of the sums of powers of so many columns.
pub(super) fn of_body(sums: &[Planes<f32>], columns: usize) -> Planes<f32> {
    let cells = sums.first().map_or(0, Planes::length);
    let mut result = Planes::new(BASES, cells + WIDTH);
    let mut ladder = CellLadder::default();
    for (vector, &short) in SHORT.iter().enumerate() {
        let mut total = vec![0.0; cells];
        for sum in sums {
            add(sum.row(vector), &mut total);
        }
        scale(1.0 / columns as f32, &mut total);
        ladder.climb(&total, short);
        logarithms(ladder.scale(short), LOGARITHM, result.row_mut(vector));
    }
    result
}

multiversion! {
    fn add(values: &[f32], out: &mut [f32]) {
        for (sum, value) in out.iter_mut().zip(values) {
            *sum += *value;
        }
    }
}

multiversion! {
    fn scale(by: f32, out: &mut [f32]) {
        for value in out {
            *value *= by;
        }
    }
}

multiversion! {
    fn logarithms(powers: &[f32], by: f32, out: &mut [f32]) {
        for (out, power) in out.iter_mut().zip(powers) {
            *out = by * ln(*power + LEAST_POWER);
        }
    }
}

multiversion! {
    /// Divides by the roots of the powers that stand in `out`.
    fn over_norm(products: &[f32], out: &mut [f32]) {
        for (out, product) in out.iter_mut().zip(products) {
            *out = *product / (*out + LEAST_NORM).sqrt();
        }
    }
}
