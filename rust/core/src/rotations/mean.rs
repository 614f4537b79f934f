//! Karcher mean: the rotation with the smallest mean squared geodesic distance to the samples.
//!
//! The gradient of `½ mean φ²` at `x` is `−mean v`, `v = log(x⁻¹ q)` with the sign of `x⁻¹ q` that has `w ≥ 0`, and its
//! Hessian is `mean[φ cot φ · I + (1 − φ cot φ) · v vᵀ/φ²]` (Pennec 2006; on S³, φ is half the rotation angle). Newton's
//! steps with it converge quadratically from the chordal mean, the main eigenvector of `Σ q qᵀ`.

use crate::parallel::{self, Interrupt};
use crate::rotations::quaternion::{between, dot, exp_one, product, unit};
use crate::simd::multiversion;
use crate::{ClipView, Error, Real, error::check_length};
use std::ops::Range;

/// Columns that are accumulated together: one vector of float32 at the widest level.
const COLUMNS: usize = 16;

/// Rows per task; the sums of a task are taken in `T`, those of the tasks in float64.
const TASK_ROWS: usize = 512;

/// Rows that are processed column by column: they fit in the first-level cache.
const CHUNK_ROWS: usize = 16;

/// Clips longer than this are first solved on a subset of about as many frames.
const SUBSET_FRAMES: usize = 4096;

/// Largest number of Newton steps; a few suffice unless the mean is not unique.
const MAX_STEPS: usize = 100;

/// Sums of a pass per joint: the total weight; then the 10 entries of `q qᵀ`, or the gradient, `φ cot φ` and the 6
/// other entries of the Hessian.
const SUMS: usize = 11;

type Sums = [f64; SUMS];

/// Karcher means of all joints of a clip, `w ≥ 0`; NaN where no sample has weight.
///
/// `weights` are `(frames, joints)`, not negative; missing samples (NaN or zero) have weight 0. The result does not
/// depend on the signs and lengths of the samples.
///
/// # Errors
/// [`Error::Length`] if the shape of the weights is not that of the clip; [`Error::Interrupted`].
pub fn mean<T: Real>(
    clip: ClipView<'_, T>,
    weights: Option<&[T]>,
    interrupt: &Interrupt,
) -> Result<Vec<[f64; 4]>, Error> {
    let (frames, joints) = (clip.frames(), clip.joints());
    if let Some(weights) = weights {
        check_length("weights", frames * joints, weights.len())?;
    }
    let stride = frames.div_ceil(SUBSET_FRAMES).max(1);
    let none = vec![[1.0, 0.0, 0.0, 0.0]; joints];
    let mut means: Vec<[f64; 4]> =
        pass(clip, weights, stride, add_moments, &none, interrupt)?.iter().map(main_direction).collect();
    let mut seen = vec![false; joints];
    if stride > 1 {
        solve(clip, weights, stride, &mut means, interrupt)?;
        // A joint may be missing in the whole subset.
        seen = means.iter().map(|m| m[0].is_finite()).collect();
    }
    if seen.iter().any(|&seen| !seen) {
        let all = pass(clip, weights, 1, add_moments, &none, interrupt)?;
        for ((mean, sums), _) in means.iter_mut().zip(&all).zip(&seen).filter(|(_, seen)| !**seen) {
            *mean = main_direction(sums);
        }
    }
    solve(clip, weights, 1, &mut means, interrupt)?;
    Ok(means.into_iter().map(|m| if m[0] < 0.0 { m.map(|x| -x) } else { m }).collect())
}

/// Newton's iteration from `means`, in place.
fn solve<T: Real>(
    clip: ClipView<'_, T>,
    weights: Option<&[T]>,
    stride: usize,
    means: &mut [[f64; 4]],
    interrupt: &Interrupt,
) -> Result<(), Error> {
    // The error after a Newton step is a few hundredths of the step's square.
    let enough = (16.0 * T::EPSILON.to_f64()).sqrt();
    let mut before = vec![f64::INFINITY; means.len()];
    for _ in 0..MAX_STEPS {
        let sums = pass(clip, weights, stride, add_newton, means, interrupt)?;
        let mut largest = 0.0_f64;
        for ((mean, sums), before) in means.iter_mut().zip(&sums).zip(&mut before) {
            let gradient = [sums[1] / sums[0], sums[2] / sums[0], sums[3] / sums[0]];
            let length = norm(gradient);
            // If Newton's step did not shorten the gradient, a gradient step does.
            let step = if length < *before { newton_step(gradient, sums) } else { gradient };
            *before = length;
            if step.iter().all(|x| x.is_finite()) {
                *mean = unit(product(*mean, exp_one(step)));
                largest = largest.max(norm(step));
            }
        }
        if largest < enough {
            break;
        }
    }
    Ok(())
}

fn norm(v: [f64; 3]) -> f64 {
    (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt()
}

/// `H⁻¹ g`, by Cramer's rule.
fn newton_step(g: [f64; 3], sums: &Sums) -> [f64; 3] {
    let n = sums[0];
    let diagonal = sums[4] / n;
    let [xx, xy, xz] = [sums[5] / n + diagonal, sums[6] / n, sums[7] / n];
    let [yy, yz, zz] = [sums[8] / n + diagonal, sums[9] / n, sums[10] / n + diagonal];
    let (cx, cy, cz) = (yy * zz - yz * yz, yz * xz - xy * zz, xy * yz - yy * xz);
    let determinant = xx * cx + xy * cy + xz * cz;
    // A determinant near 0 means samples about 180° away, where the Hessian is unreliable.
    if determinant < 1e-6 {
        return g;
    }
    [
        (cx * g[0] + cy * g[1] + cz * g[2]) / determinant,
        (cy * g[0] + (xx * zz - xz * xz) * g[1] + (xy * xz - xx * yz) * g[2]) / determinant,
        (cz * g[0] + (xy * xz - xx * yz) * g[1] + (xx * yy - xy * xy) * g[2]) / determinant,
    ]
}

/// The main eigenvector of the symmetric 4 × 4 matrix whose upper triangle is `sums[1..]`, by repeated squaring.
fn main_direction(sums: &Sums) -> [f64; 4] {
    /// Number of squarings: they separate eigenvalues whose ratio is above `1 + 2⁻⁴⁰`.
    const SQUARINGS: usize = 46;
    let mut m = [
        [sums[1], sums[2], sums[3], sums[4]],
        [sums[2], sums[5], sums[6], sums[7]],
        [sums[3], sums[6], sums[8], sums[9]],
        [sums[4], sums[7], sums[9], sums[10]],
    ];
    for _ in 0..SQUARINGS {
        let trace = m[0][0] + m[1][1] + m[2][2] + m[3][3];
        let scaled = m.map(|row| row.map(|x| x / trace));
        for i in 0..4 {
            for j in 0..4 {
                m[i][j] = (0..4).map(|k| scaled[i][k] * scaled[k][j]).sum();
            }
        }
    }
    let largest = (0..4).fold(0, |best, i| if m[i][i] > m[best][best] { i } else { best });
    unit(m[largest])
}

/// Kernel that adds the frames of some columns: [`add_moments`] or [`add_newton`].
type Kernel<T> = fn(&Columns<'_, T>, &[[T; 4]; COLUMNS], &mut [[T; COLUMNS]; SUMS]);

/// Sums of `kernel` at `means` over every `stride`-th row, per joint.
///
/// A row is one frame, or with few joints as many frames as fill a vector.
fn pass<T: Real>(
    clip: ClipView<'_, T>,
    weights: Option<&[T]>,
    stride: usize,
    kernel: Kernel<T>,
    means: &[[f64; 4]],
    interrupt: &Interrupt,
) -> Result<Vec<Sums>, Error> {
    let joints = clip.joints();
    let mut total = vec![[0.0; SUMS]; joints];
    if joints == 0 {
        return Ok(total);
    }
    let (samples, _) = clip.data().as_chunks::<4>();
    let length = joints * COLUMNS.div_ceil(joints);
    let rows = samples.len() / length;
    // The last block overlaps the previous one, so that all have the same width; `from` is its first column that is
    // used.
    let blocks: Vec<Block<T>> = (0..length)
        .step_by(COLUMNS)
        .map(|from| {
            let start = from.min(length - COLUMNS);
            let centre = std::array::from_fn(|c| means[(start + c) % joints].map(T::from_f64));
            Block { start, from: from - start, centre }
        })
        .collect();
    let used = rows.div_ceil(stride);
    let mut tasks: Vec<Range<usize>> =
        (0..used).step_by(TASK_ROWS).map(|first| first..(first + TASK_ROWS).min(used)).collect();
    // Frames that do not fill a row; a subset omits them.
    if stride == 1 && rows * length < samples.len() {
        tasks.push(rows..rows + 1);
    }
    let parts = parallel::map(tasks, used * length * 3, |_, task| {
        interrupt.check()?;
        let mut sums = vec![[[T::ZERO; COLUMNS]; SUMS]; blocks.len()];
        for first in task.clone().step_by(CHUNK_ROWS) {
            let rows = first..(first + CHUNK_ROWS).min(task.end);
            for (sums, block) in sums.iter_mut().zip(&blocks) {
                let columns = Columns {
                    samples,
                    weights,
                    start: block.start,
                    step: length * stride,
                    rows: rows.clone(),
                };
                kernel(&columns, &block.centre, sums);
            }
        }
        Ok(sums)
    })?;
    for part in &parts {
        for (block, sums) in blocks.iter().zip(part) {
            for column in block.from..COLUMNS {
                let total = &mut total[(block.start + column) % joints];
                for (total, sums) in total.iter_mut().zip(sums) {
                    *total += sums[column].to_f64();
                }
            }
        }
    }
    Ok(total)
}

/// [`COLUMNS`] neighbouring columns of the rows.
struct Block<T> {
    start: usize,
    from: usize,
    centre: [[T; 4]; COLUMNS],
}

/// [`COLUMNS`] samples from `start` in a range of rows that begin `step` samples apart.
struct Columns<'a, T> {
    samples: &'a [[T; 4]],
    weights: Option<&'a [T]>,
    start: usize,
    step: usize,
    rows: Range<usize>,
}

impl<T: Real> Columns<'_, T> {
    /// Quaternions and weights of one row; missing samples become 1 with weight 0.
    #[inline(always)]
    fn load(&self, row: usize) -> ([[T; COLUMNS]; 4], [T; COLUMNS]) {
        let at = row * self.step + self.start;
        let near: [[T; 4]; COLUMNS] = filled(self.samples, at);
        let given = match self.weights {
            Some(weights) => filled(weights, at),
            None => [T::ONE; COLUMNS],
        };
        let mut weight = [T::ZERO; COLUMNS];
        let mut q = [[T::ZERO; COLUMNS]; 4];
        for c in 0..COLUMNS {
            let square = dot(near[c], near[c]);
            // A comparison with NaN is false.
            let valid = (square > T::TINY_SQUARE) & (square < T::ONE / T::TINY_SQUARE);
            q[0][c] = if valid { near[c][0] } else { T::ONE };
            q[1][c] = if valid { near[c][1] } else { T::ZERO };
            q[2][c] = if valid { near[c][2] } else { T::ZERO };
            q[3][c] = if valid { near[c][3] } else { T::ZERO };
            weight[c] = if valid { given[c] } else { T::ZERO };
        }
        (q, weight)
    }
}

/// [`COLUMNS`] entries from `at` on, padded with zeros past the end.
#[inline(always)]
fn filled<V: Copy + Default>(values: &[V], at: usize) -> [V; COLUMNS] {
    if let Some(full) = values.get(at..at + COLUMNS) {
        return std::array::from_fn(|c| full[c]);
    }
    std::array::from_fn(|c| values.get(at + c).copied().unwrap_or_default())
}

multiversion! {
    /// Sums of the entries of `q qᵀ`.
    fn add_moments<T: Real>(columns: &Columns<'_, T>, _centre: &[[T; 4]; COLUMNS], sums: &mut [[T; COLUMNS]; SUMS]) {
        let total = sums;
        let mut sums = *total;
        for row in columns.rows.clone() {
            let (q, weight) = columns.load(row);
            for c in 0..COLUMNS {
                let [w, x, y, z] = [q[0][c], q[1][c], q[2][c], q[3][c]];
                let n = weight[c];
                let (nw, nx, ny) = (n * w, n * x, n * y);
                sums[0][c] += n;
                sums[1][c] += nw * w;
                sums[2][c] += nw * x;
                sums[3][c] += nw * y;
                sums[4][c] += nw * z;
                sums[5][c] += nx * x;
                sums[6][c] += nx * y;
                sums[7][c] += nx * z;
                sums[8][c] += ny * y;
                sums[9][c] += ny * z;
                sums[10][c] += n * z * z;
            }
        }
        *total = sums;
    }
}

multiversion! {
    /// Sums of the gradient and of the Hessian of `½ φ²` at `centre`.
    fn add_newton<T: Real>(columns: &Columns<'_, T>, centre: &[[T; 4]; COLUMNS], sums: &mut [[T; COLUMNS]; SUMS]) {
        let total = sums;
        let mut sums = *total;
        for row in columns.rows.clone() {
            let (q, weight) = columns.load(row);
            for c in 0..COLUMNS {
                let d = between(centre[c], [q[0][c], q[1][c], q[2][c], q[3][c]]);
                let square = d[1] * d[1] + d[2] * d[2] + d[3] * d[3];
                let sine = (square + T::TINY_SQUARE).sqrt();
                let inverse = T::ONE / sine;
                let factor = sine.atan2_nonnegative(d[0].abs()) * inverse;
                let cotangent = factor * d[0].abs();
                let rest = (T::ONE - cotangent) * inverse * inverse;
                let signed = (weight[c] * factor).copysign(d[0]);
                let n = weight[c] * rest;
                let (nx, ny) = (n * d[1], n * d[2]);
                sums[0][c] += weight[c];
                sums[1][c] += signed * d[1];
                sums[2][c] += signed * d[2];
                sums[3][c] += signed * d[3];
                sums[4][c] += weight[c] * cotangent;
                sums[5][c] += nx * d[1];
                sums[6][c] += nx * d[2];
                sums[7][c] += nx * d[3];
                sums[8][c] += ny * d[2];
                sums[9][c] += ny * d[3];
                sums[10][c] += n * d[3] * d[3];
            }
        }
        *total = sums;
    }
}
