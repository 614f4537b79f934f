//! The chart of some examples: rotations of poses as vectors.

use super::LANE;
use super::dense::{Matrix, halves};
use crate::Real;
use crate::rotations::quaternion::{between, dot, log_short, of_row, unit};
use crate::simd::multiversion;

/// The components of all rotations of `count` examples, a row for each: four for each joint in each frame.
pub(super) fn components<T: Real>(segments: &[T], places: usize, count: usize) -> Matrix {
    let mut matrix = Matrix::new(places * 4, count);
    let width = matrix.width();
    for (place, rows) in matrix.data_mut().chunks_exact_mut(4 * width).enumerate() {
        for (example, pose) in segments.chunks_exact(places * 4).enumerate() {
            let q = &pose[place * 4..place * 4 + 4];
            rows[example] = q[0].to_f64();
            rows[width + example] = q[1].to_f64();
            rows[2 * width + example] = q[2].to_f64();
            rows[3 * width + example] = q[3].to_f64();
        }
    }
    matrix
}

/// Where each joint's chart touches the rotations: the renormalised mean of all poses, with signs as seen from the first example
/// in the frame `reference`.
pub(super) fn mean(components: &Matrix, joints: usize, reference: usize) -> Vec<[f64; 4]> {
    let width = components.width();
    let rows = |place: usize| &components.data()[place * 4 * width..][..4 * width];
    let places = components.data().len() / (4 * width);
    (0..joints)
        .map(|joint| {
            let from = rows(reference * joints + joint);
            let from = [from[0], from[width], from[2 * width], from[3 * width]];
            let mut sums = [[0.0; LANE]; 4];
            for place in (joint..places).step_by(joints) {
                add_alike(rows(place), from, &mut sums);
            }
            unit(sums.map(halves))
        })
        .collect()
}

multiversion! {
    /// Adds rotations to `sums`, with signs as seen from one of them. What stands beyond the examples is zero.
    fn add_alike(rows: &[f64], from: [f64; 4], sums: &mut [[f64; LANE]; 4]) {
        let width = rows.len() / 4;
        for left in (0..width).step_by(LANE) {
            let q = quarters(rows, width, left);
            for j in 0..LANE {
                let q = [q[0][j], q[1][j], q[2][j], q[3][j]];
                let sign = if dot(q, from) < 0.0 { -1.0 } else { 1.0 };
                for c in 0..4 {
                    sums[c][j] += sign * q[c];
                }
            }
        }
    }
}

/// A lane of each of four rows.
#[inline(always)]
fn quarters(rows: &[f64], width: usize, left: usize) -> [[f64; LANE]; 4] {
    let mut q = [[0.0; LANE]; 4];
    for (c, q) in q.iter_mut().enumerate() {
        q.copy_from_slice(&rows[c * width + left..][..LANE]);
    }
    q
}

/// Rotation vector `2 log(c⁻¹ q)`, the shorter way.
#[inline(always)]
fn vector(chart: [f64; 4], q: [f64; 4]) -> [f64; 3] {
    let half = log_short(between(chart, q));
    [2.0 * half[0], 2.0 * half[1], 2.0 * half[2]]
}

multiversion! {
    /// Rotation vectors of four rows of components, as three rows. What stands beyond the examples is finite.
    fn write_vectors(rows: &[f64], chart: [f64; 4], out: &mut [f64]) {
        let width = rows.len() / 4;
        for left in (0..width).step_by(LANE) {
            let q = quarters(rows, width, left);
            let mut v = [[0.0; LANE]; 3];
            for j in 0..LANE {
                let vector = vector(chart, [q[0][j], q[1][j], q[2][j], q[3][j]]);
                v[0][j] = vector[0];
                v[1][j] = vector[1];
                v[2][j] = vector[2];
            }
            for (c, v) in v.iter().enumerate() {
                out[c * width + left..][..LANE].copy_from_slice(v);
            }
        }
    }
}

/// Rotation vectors of examples, a row for each coordinate.
pub(super) fn vectors(components: &Matrix, chart: &[[f64; 4]]) -> Matrix {
    let width = components.width();
    let places = components.data().len() / (4 * width);
    let mut matrix = Matrix::new(places * 3, components.columns());
    let rows = components.data().chunks_exact(4 * width);
    for (place, (rows, out)) in rows.zip(matrix.data_mut().chunks_exact_mut(3 * width)).enumerate() {
        write_vectors(rows, chart[place % chart.len()], out);
    }
    matrix
}

/// Rotation vectors of poses in sequence.
pub(super) fn of_poses<T: Real>(poses: &[T], chart: &[[f64; 4]]) -> Vec<f64> {
    let (rotations, _) = poses.as_chunks::<4>();
    let seen = |(place, q): (usize, &[T; 4])| vector(chart[place % chart.len()], of_row(q).map(T::to_f64));
    rotations.iter().enumerate().flat_map(seen).collect()
}
