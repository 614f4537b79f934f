//! The chart of the examples: rotations of poses as rotation vectors.

use super::LANE;
use super::dense::{Matrix, halves};
use crate::Real;
use crate::clip::Planes;
use crate::rotations::quaternion::{between, dot, log_short, of_row, unit};
use crate::simd::multiversion;

/// Charts of all joints and the examples' rotation vectors in them, one row per coordinate: first the frames before
/// the last, then the last frame. `more` is the number of zero rows appended to each.
///
/// The centre of a chart is the normalised mean of all poses, with signs relative to the first example's last pose
/// but one.
pub(super) fn vectors<T: Real>(
    segments: &[T],
    (count, frames, joints): (usize, usize, usize),
    more: [usize; 2],
) -> (Vec<[f64; 4]>, Matrix, Matrix) {
    let mut inputs = Matrix::new((frames - 1) * joints * 3 + more[0], count);
    let mut outputs = Matrix::new(joints * 3 + more[1], count);
    let width = inputs.width();
    let mut components = Planes::new(1, frames * 4 * width);
    let mut charts = Vec::with_capacity(joints);
    for joint in 0..joints {
        for (k, example) in segments.chunks_exact(frames * joints * 4).enumerate() {
            let rows = components.row_mut(0).chunks_exact_mut(4 * width);
            for (pose, rows) in example.chunks_exact(joints * 4).zip(rows) {
                let q = &pose[joint * 4..joint * 4 + 4];
                for c in 0..4 {
                    rows[c * width + k] = q[c].to_f64();
                }
            }
        }
        let rows = || components.row(0).chunks_exact(4 * width);
        let from = &components.row(0)[(frames - 2) * 4 * width..];
        let from = [from[0], from[width], from[2 * width], from[3 * width]];
        let mut sums = [[0.0; LANE]; 4];
        for rows in rows() {
            add_alike(rows, from, &mut sums);
        }
        let chart = unit(sums.map(halves));
        charts.push(chart);
        for (frame, rows) in rows().enumerate() {
            let last = frame == frames - 1;
            let row = if last { joint } else { frame * joints + joint };
            let to = if last { &mut outputs } else { &mut inputs };
            write_vectors(rows, chart, &mut to.data_mut()[row * 3 * width..][..3 * width]);
        }
    }
    (charts, inputs, outputs)
}

multiversion! {
    /// Adds quaternions to `sums`, with signs relative to `from`. The padding beyond the examples is zero.
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

/// Rotation vector `2 log(c⁻¹ q)` of the shorter rotation.
#[inline(always)]
fn vector(chart: [f64; 4], q: [f64; 4]) -> [f64; 3] {
    let half = log_short(between(chart, q));
    [2.0 * half[0], 2.0 * half[1], 2.0 * half[2]]
}

multiversion! {
    /// Rotation vectors of four rows of components, as three rows. The values in the padding are finite.
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

/// Rotation vectors of consecutive poses.
pub(super) fn of_poses<T: Real>(poses: &[T], chart: &[[f64; 4]]) -> Vec<f64> {
    let (rotations, _) = poses.as_chunks::<4>();
    let seen = |(place, q): (usize, &[T; 4])| vector(chart[place % chart.len()], of_row(q).map(T::to_f64));
    rotations.iter().enumerate().flat_map(seen).collect()
}
