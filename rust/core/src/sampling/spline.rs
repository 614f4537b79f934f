//! Values at the source's measurements, and back to all frames by a natural cubic spline of the development.
//!
//! The development in the frame that is carried along is a path in R³. With a cut-off, it is first smoothed, four times about the
//! result of the round before: `Σ h_i |x_i − y_i|² + λ ∫ |x″|² dt → min`, `λ = (2π · cutoff)⁻⁴`, with the local spacing `h_i` as weights.
//! Reinsch: `(R + λ Qᵀ W⁻¹ Q) γ = Qᵀ y`, `x = y − λ W⁻¹ Q γ`.

use crate::error::check_length;
use crate::parallel::{self, Interrupt};
use crate::rotations::continuity::make_continuous;
use crate::rotations::quaternion::{
    between, conjugate_one, dot, exp_one, is_missing, log_short, negative, product, rotate, unit,
};
use crate::{Error, Real};

/// Radians between two samples from which a joint jumps: a spline through a jump would swing on both sides of it.
const JUMP: f64 = 1.0;

/// How often the path is smoothed about the result of the round before.
const ROUNDS: usize = 4;

/// Estimated nanoseconds per sample and round.
const NANOSECONDS: usize = 300;

type Vector = [f64; 3];
type Quaternion = [f64; 4];

/// Rotations `(frames, joints, 4)`, or positions `(frames, joints, 3)`.
#[derive(Debug, Clone, Copy)]
pub struct Series<'a, T> {
    /// The values.
    pub values: &'a [T],
    /// Joints, or points.
    pub joints: usize,
    /// Numbers of each: 4 or 3.
    pub width: usize,
}

impl<T: Real> Series<'_, T> {
    /// Length of a frame.
    fn row(&self) -> usize {
        self.joints * self.width
    }

    fn vector(&self, frame: usize, joint: usize) -> Vector {
        std::array::from_fn(|c| self.values[frame * self.row() + joint * 3 + c].to_f64())
    }

    fn sample(&self, frame: usize, joint: usize) -> Option<Quaternion> {
        let q = std::array::from_fn(|c| self.values[frame * self.row() + joint * 4 + c]);
        if is_missing(q) { None } else { Some(unit(q.map(T::to_f64))) }
    }
}

/// Values at times between frames: the frame before, moved on by the increment that leads to it, `q_k exp(f w_{k−1} / 2)`.
///
/// # Errors
/// [`Error::Length`] if the slices do not fit; [`Error::Parameter`] for times outside of the frames.
pub fn knots<T: Real>(q: Series<'_, T>, times: &[f64], out: &mut [T]) -> Result<(), Error> {
    let row = q.row();
    check_length("out", times.len() * row, out.len())?;
    let frames = q.values.len().checked_div(row).unwrap_or_default();
    for (&time, out) in times.iter().zip(out.chunks_mut(row.max(1))) {
        let whole = time.to_count();
        if whole >= frames || time.is_nan() || time < 0.0 {
            return Err(Error::Parameter { name: "times", expected: "times of frames" });
        }
        let (part, before) = (time - whole as f64, whole.saturating_sub(1));
        for (joint, out) in out.chunks_exact_mut(q.width).enumerate() {
            if q.width == 3 {
                let (a, b) = (q.vector(before, joint), q.vector(whole, joint));
                for c in 0..3 {
                    out[c] = T::from_f64(b[c] + part * (b[c] - a[c]));
                }
                continue;
            }
            let here = q.sample(whole, joint);
            let there = if part > 0.0 { q.sample(before, joint) } else { here };
            let moved = here.zip(there).map(|(here, there)| {
                product(here, exp_one(log_short(between(there, here)).map(|x| part * x)))
            });
            for (value, out) in moved.unwrap_or([f64::NAN; 4]).into_iter().zip(out) {
                *out = T::from_f64(value);
            }
        }
    }
    Ok(())
}

/// Values at new times along a spline of the development; NaN beside missing samples, continuous in sign.
///
/// # Errors
/// [`Error::Length`] if the slices do not fit; [`Error::Interrupted`].
pub fn spline<T: Real>(
    q: Series<'_, T>,
    times: &[f64],
    new_times: &[f64],
    cutoff: f64,
    out: &mut [T],
    interrupt: &Interrupt,
) -> Result<(), Error> {
    check_length("times", q.values.len(), times.len() * q.row())?;
    check_length("out", new_times.len() * q.row(), out.len())?;
    let circular = 2.0 * std::f64::consts::PI * cutoff;
    let stiffness = if cutoff > 0.0 { 1.0 / (circular * circular * circular * circular) } else { 0.0 };
    let joints: Vec<usize> = (0..q.joints).collect();
    let work = (times.len() * ROUNDS + new_times.len()) * q.joints * NANOSECONDS;
    let columns = parallel::map(joints, work, |_, joint| {
        interrupt.check()?;
        Ok(column(q, joint, times, new_times, stiffness))
    })?;
    for (joint, column) in columns.iter().enumerate() {
        for (frame, value) in column.iter().enumerate() {
            let at = frame * q.row() + joint * q.width;
            for (out, value) in out[at..at + q.width].iter_mut().zip(value) {
                *out = T::from_f64(*value);
            }
        }
    }
    if q.width == 4 && !out.is_empty() { make_continuous(out, q.joints) } else { Ok(()) }
}

/// One joint, or point; of positions the last number is not used.
fn column<T: Real>(
    q: Series<'_, T>,
    joint: usize,
    times: &[f64],
    new_times: &[f64],
    stiffness: f64,
) -> Vec<Quaternion> {
    let mut result = vec![[f64::NAN; 4]; new_times.len()];
    if times.is_empty() {
        return result;
    }
    if q.width == 3 {
        let values: Vec<Vector> = (0..times.len()).map(|i| q.vector(i, joint)).collect();
        let smooth = smoothed(&values, times, stiffness);
        let curve = Curve { values: &smooth, times, curvature: &curvature(&smooth, times) };
        for (result, &time) in result.iter_mut().zip(new_times) {
            let [x, y, z] = curve.at(time).1;
            *result = [x, y, z, 0.0];
        }
        return result;
    }
    let samples: Vec<Option<Quaternion>> = (0..times.len()).map(|i| q.sample(i, joint)).collect();
    let known: Vec<f64> =
        times.iter().zip(&samples).filter(|(_, sample)| sample.is_some()).map(|(&time, _)| time).collect();
    let mut path: Vec<Quaternion> = samples.iter().flatten().copied().collect();
    if path.is_empty() {
        return result;
    }
    for i in 1..path.len() {
        if dot(path[i - 1], path[i]) < 0.0 {
            path[i] = negative(path[i]);
        }
    }
    // The first sample of each piece between jumps, and the end.
    let jumps = |&i: &usize| {
        let half = log_short(between(path[i - 1], path[i]));
        2.0 * (half[0] * half[0] + half[1] * half[1] + half[2] * half[2]).sqrt() > JUMP
    };
    let mut starts: Vec<usize> = std::iter::once(0).chain((1..path.len()).filter(jumps)).collect();
    starts.push(path.len());
    let mut smooth = path.clone();
    for piece in starts.windows(2) {
        let piece = piece[0]..piece[1];
        smooth_path(&path[piece.clone()], &known[piece.clone()], stiffness, &mut smooth[piece]);
    }
    let pieces: Vec<Piece> = starts
        .windows(2)
        .map(|piece| {
            let (frame, development) = carried(&smooth[piece[0]..piece[1]]);
            Piece {
                start: piece[0],
                frame,
                curvature: curvature(&development, &known[piece[0]..piece[1]]),
                development,
            }
        })
        .collect();
    for (result, &time) in result.iter_mut().zip(new_times) {
        let left = interval(times, time);
        let right = (left + 1).min(times.len() - 1);
        let between_samples = (times[left] - time).abs() > 0.0;
        if samples[left].is_none() || between_samples && samples[right].is_none() {
            continue;
        }
        // The sample before the time, or the first one.
        let at = known.partition_point(|&t| t <= time).saturating_sub(1);
        let number = starts.partition_point(|&start| start <= at) - 1;
        let across = time > known[at] && at + 1 < path.len() && at + 1 == starts[number + 1];
        *result = if across {
            let part = (time - known[at]) / (known[at + 1] - known[at]);
            let half = log_short(between(smooth[at], smooth[at + 1]));
            unit(product(smooth[at], exp_one(half.map(|x| part * x))))
        } else {
            let piece = &pieces[number];
            let end = starts[number + 1];
            let curve = Curve {
                values: &piece.development,
                times: &known[piece.start..end],
                curvature: &piece.curvature,
            };
            let (i, at) = curve.at(time);
            unit(turned(smooth[piece.start + i], piece.frame[i], at, piece.development[i]))
        };
    }
    result
}

/// A path between two jumps, rolled out.
struct Piece {
    start: usize,
    frame: Vec<Quaternion>,
    curvature: Vec<Vector>,
    development: Vec<Vector>,
}

/// Smooths a path, [`ROUNDS`] times about the result of the round before; `reference` holds the path before.
fn smooth_path(path: &[Quaternion], times: &[f64], stiffness: f64, reference: &mut [Quaternion]) {
    for _ in 0..if stiffness > 0.0 { ROUNDS } else { 0 } {
        let (frame, development) = carried(reference);
        let vectors: Vec<Vector> = (0..path.len())
            .map(|i| {
                let way = log_short(between(reference[i], path[i])).map(|x| 2.0 * x);
                sum(development[i], rotate(frame[i], way))
            })
            .collect();
        let moved = smoothed(&vectors, times, stiffness);
        for i in 0..path.len() {
            reference[i] = unit(turned(reference[i], frame[i], moved[i], development[i]));
        }
    }
}

/// The rotation `r · exp(h⁻¹ (x − R) / 2)`.
fn turned(reference: Quaternion, frame: Quaternion, at: Vector, development: Vector) -> Quaternion {
    let way = std::array::from_fn(|c| (at[c] - development[c]) / 2.0);
    product(reference, exp_one(rotate(conjugate_one(frame), way)))
}

/// The frame that is carried along a path, and the path's development in it.
fn carried(path: &[Quaternion]) -> (Vec<Quaternion>, Vec<Vector>) {
    let mut frames = vec![[1.0, 0.0, 0.0, 0.0]; path.len()];
    let mut development = vec![[0.0; 3]; path.len()];
    for t in 1..path.len() {
        let half = log_short(between(path[t - 1], path[t]));
        frames[t] = unit(product(frames[t - 1], exp_one(half.map(|x| x / 2.0))));
        development[t] = sum(development[t - 1], rotate(frames[t - 1], half.map(|x| 2.0 * x)));
    }
    (frames, development)
}

fn sum(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|c| a[c] + b[c])
}

/// The interval that a time lies in; the first and last one go on beyond the ends.
fn interval(times: &[f64], time: f64) -> usize {
    let after = times.partition_point(|&t| t <= time);
    after.saturating_sub(1).min(times.len().saturating_sub(2))
}

/// A natural cubic spline through vectors.
struct Curve<'a> {
    values: &'a [Vector],
    times: &'a [f64],
    curvature: &'a [Vector],
}

/// Second derivatives of the natural cubic spline at its knots.
fn curvature(values: &[Vector], times: &[f64]) -> Vec<Vector> {
    let mut curvature = vec![[0.0; 3]; values.len()];
    if values.len() > 2 {
        let h = spacing(times);
        let inner = solve(curvature_bands(&h), second_differences(values, &h));
        curvature[1..values.len() - 1].copy_from_slice(&inner);
    }
    curvature
}

impl Curve<'_> {
    /// The interval of a time, and the value there; straight lines lead beyond the ends.
    fn at(&self, time: f64) -> (usize, Vector) {
        let n = self.values.len();
        if n < 2 {
            return (0, self.values[0]);
        }
        let i = interval(self.times, time);
        let inside = time.clamp(self.times[0], self.times[n - 1]);
        let h = self.times[i + 1] - self.times[i];
        let b = (inside - self.times[i]) / h;
        let a = 1.0 - b;
        let (cubic_a, cubic_b) = (a * a * a - a, b * b * b - b);
        let (slope_a, slope_b) = (3.0 * a * a - 1.0, 3.0 * b * b - 1.0);
        let value = std::array::from_fn(|c| {
            let (x, y) = (self.values[i][c], self.values[i + 1][c]);
            let (k, l) = (self.curvature[i][c], self.curvature[i + 1][c]);
            let slope = (y - x) / h + (slope_b * l - slope_a * k) * h / 6.0;
            a * x + b * y + (cubic_a * k + cubic_b * l) * h * h / 6.0 + slope * (time - inside)
        });
        (i, value)
    }
}

/// Values of the smoothing spline at its knots.
fn smoothed(values: &[Vector], times: &[f64], stiffness: f64) -> Vec<Vector> {
    let n = values.len();
    if n < 3 || stiffness <= 0.0 {
        return values.to_vec();
    }
    let h = spacing(times);
    let weight = |i: usize| {
        let before = if i > 0 { h[i - 1] } else { 0.0 };
        0.5 * (before + if i < n - 1 { h[i] } else { 0.0 })
    };
    // Column i of Q: second divided differences at the knots i, i + 1, i + 2.
    let q = |i: usize| [1.0 / h[i], -1.0 / h[i] - 1.0 / h[i + 1], 1.0 / h[i + 1]];
    let mut bands = curvature_bands(&h);
    for (c, column) in bands.iter_mut().enumerate() {
        for (k, entry) in column.iter_mut().enumerate().take(n - 2 - c) {
            let shared: f64 = (0..3 - k).map(|i| q(c)[i + k] * q(c + k)[i] / weight(c + k + i)).sum();
            *entry += stiffness * shared;
        }
    }
    let curvature = solve(bands, second_differences(values, &h));
    let mut result = values.to_vec();
    for (c, curvature) in curvature.iter().enumerate() {
        for (i, coefficient) in q(c).into_iter().enumerate() {
            for (x, bent) in result[c + i].iter_mut().zip(curvature) {
                *x -= stiffness * coefficient * bent / weight(c + i);
            }
        }
    }
    result
}

fn spacing(times: &[f64]) -> Vec<f64> {
    times.windows(2).map(|pair| pair[1] - pair[0]).collect()
}

/// Second divided differences of values at knots `h` apart.
fn second_differences(values: &[Vector], h: &[f64]) -> Vec<Vector> {
    (0..values.len() - 2)
        .map(|i| {
            std::array::from_fn(|c| {
                let [x, y, z] = [values[i][c], values[i + 1][c], values[i + 2][c]];
                (z - y) / h[i + 1] - (y - x) / h[i]
            })
        })
        .collect()
}

/// Rows of the diagonal and the two bands below it of `R`, the Gram matrix of the hat functions of the inner knots.
fn curvature_bands(h: &[f64]) -> Vec<[f64; 3]> {
    let n = h.len() - 1;
    (0..n).map(|i| [(h[i] + h[i + 1]) / 3.0, if i + 1 < n { h[i + 1] / 6.0 } else { 0.0 }, 0.0]).collect()
}

/// Solves a symmetric positive system whose column `t` holds the entries `(t + k, t)`, `k = 0, 1, 2`: `M = L D Lᵀ`.
fn solve(mut bands: Vec<[f64; 3]>, mut right: Vec<Vector>) -> Vec<Vector> {
    let n = right.len();
    for t in 0..n {
        let [pivot, first, second] = bands[t];
        let lower = [first / pivot, second / pivot];
        let value = right[t];
        if t + 1 < n {
            bands[t + 1][0] -= lower[0] * first;
            bands[t + 1][1] -= lower[0] * second;
            right[t + 1] = std::array::from_fn(|c| right[t + 1][c] - lower[0] * value[c]);
        }
        if t + 2 < n {
            bands[t + 2][0] -= lower[1] * second;
            right[t + 2] = std::array::from_fn(|c| right[t + 2][c] - lower[1] * value[c]);
        }
        bands[t] = [pivot, lower[0], lower[1]];
    }
    for t in (0..n).rev() {
        let [pivot, first, second] = bands[t];
        right[t] = std::array::from_fn(|c| {
            let after = if t + 1 < n { first * right[t + 1][c] } else { 0.0 };
            right[t][c] / pivot - after - if t + 2 < n { second * right[t + 2][c] } else { 0.0 }
        });
    }
    right
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_goes_through_its_knots_and_on_in_straight_lines() {
        let times = [0.0, 1.0, 2.5, 3.0, 5.0];
        let values: Vec<Vector> = times.iter().map(|&t| [t * t, 1.0 - t, 2.0]).collect();
        let curve = Curve { values: &values, times: &times, curvature: &curvature(&values, &times) };
        for (time, value) in times.iter().zip(&values) {
            let found = curve.at(*time).1;
            assert!(found.iter().zip(value).all(|(a, b)| (a - b).abs() < 1e-12));
        }
        let [a, b, c] = [5.0, 6.0, 7.0].map(|time| curve.at(time).1);
        assert!((0..3).all(|i| (a[i] - 2.0 * b[i] + c[i]).abs() < 1e-9));
    }

    #[test]
    fn straight_lines_are_not_smoothed() {
        let times = [0.0, 1.0, 2.5, 3.0, 5.0];
        let values: Vec<Vector> = times.iter().map(|&t| [2.0 * t, 1.0 - t, 2.0]).collect();
        let smooth = smoothed(&values, &times, 10.0);
        assert!(smooth.iter().flatten().zip(values.iter().flatten()).all(|(a, b)| (a - b).abs() < 1e-12));
    }
}
