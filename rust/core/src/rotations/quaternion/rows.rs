//! Arrays of quaternions, one row each: chunks of rows become planes, and the planes vectorise.

use super::one::{angle_between, conjugate_one, exp_one, log_one, product, unit};
use crate::error::check_length;
use crate::simd::multiversion;
use crate::{Error, Real, parallel};

/// Quaternions per chunk: four planes of float64 in and out fit in the first-level cache.
const CHUNK: usize = 64;

/// Quaternions per task.
const TASK: usize = 16 * 1024;

/// Reads up to [`CHUNK`] rows of `N` components into planes.
#[inline(always)]
fn load<T: Real, const N: usize>(rows: &[T], planes: &mut [[T; CHUNK]; N]) {
    for (i, row) in rows.chunks_exact(N).enumerate().take(CHUNK) {
        for (plane, &x) in planes.iter_mut().zip(row) {
            plane[i] = x;
        }
    }
}

/// Writes up to [`CHUNK`] rows of `N` components from planes.
#[inline(always)]
fn store<T: Real, const N: usize>(planes: &[[T; CHUNK]; N], rows: &mut [T]) {
    for (i, row) in rows.chunks_exact_mut(N).enumerate().take(CHUNK) {
        for (plane, x) in planes.iter().zip(row) {
            *x = plane[i];
        }
    }
}

/// Applies `f` to rows of `A` components, giving rows of `B`.
#[inline(always)]
pub(in crate::rotations) fn map_rows<T: Real, const A: usize, const B: usize>(
    a: &[T],
    out: &mut [T],
    f: impl Fn([T; A]) -> [T; B],
) {
    for (a, out) in a.chunks(CHUNK * A).zip(out.chunks_mut(CHUNK * B)) {
        let mut from = [[T::ONE; CHUNK]; A];
        let mut to = [[T::ZERO; CHUNK]; B];
        load(a, &mut from);
        for i in 0..CHUNK {
            let value = f(std::array::from_fn(|c| from[c][i]));
            for c in 0..B {
                to[c][i] = value[c];
            }
        }
        store(&to, out);
    }
}

/// Applies `f` to pairs of quaternions, giving rows of `B`.
#[inline(always)]
fn zip_rows<T: Real, const B: usize>(a: &[T], b: &[T], out: &mut [T], f: impl Fn([T; 4], [T; 4]) -> [T; B]) {
    for ((a, b), out) in a.chunks(CHUNK * 4).zip(b.chunks(CHUNK * 4)).zip(out.chunks_mut(CHUNK * B)) {
        let mut left = [[T::ONE; CHUNK]; 4];
        let mut right = [[T::ONE; CHUNK]; 4];
        let mut to = [[T::ZERO; CHUNK]; B];
        load(a, &mut left);
        load(b, &mut right);
        for i in 0..CHUNK {
            let value = f(std::array::from_fn(|c| left[c][i]), std::array::from_fn(|c| right[c][i]));
            for c in 0..B {
                to[c][i] = value[c];
            }
        }
        store(&to, out);
    }
}

multiversion! {
    fn multiply_rows<T: Real>(a: &[T], b: &[T], out: &mut [T]) {
        zip_rows(a, b, out, product);
    }
}
multiversion! {
    fn distance_rows<T: Real>(a: &[T], b: &[T], out: &mut [T]) {
        zip_rows(a, b, out, |a, b| [angle_between(a, b)]);
    }
}
multiversion! {
    fn log_rows<T: Real>(q: &[T], out: &mut [T]) {
        map_rows(q, out, log_one);
    }
}
multiversion! {
    fn exp_rows<T: Real>(v: &[T], out: &mut [T]) {
        map_rows(v, out, exp_one);
    }
}
multiversion! {
    fn normalize_rows<T: Real>(q: &[T], out: &mut [T]) {
        map_rows(q, out, unit);
    }
}

/// Splits arrays of `n` rows into tasks and runs `work` on each.
pub(in crate::rotations) fn rows<T: Real>(
    n: usize,
    nanoseconds: usize,
    out: &mut [T],
    columns: usize,
    work: impl Fn(std::ops::Range<usize>, &mut [T]) + Sync + Send,
) -> Result<(), Error> {
    let tasks: Vec<&mut [T]> = out.chunks_mut(TASK * columns).collect();
    parallel::for_each(tasks, n * nanoseconds, |task, out| {
        let start = task * TASK;
        work(start..start + out.len() / columns, out);
        Ok(())
    })
}

/// Hamilton products of `n` pairs, `(n, 4)` each.
///
/// # Errors
/// [`Error::Length`] if the slices differ in length.
pub fn multiply<T: Real>(a: &[T], b: &[T], out: &mut [T]) -> Result<(), Error> {
    check_length("b", a.len(), b.len())?;
    check_length("out", a.len(), out.len())?;
    rows(a.len() / 4, 2, out, 4, |r, out| {
        multiply_rows(&a[r.start * 4..r.end * 4], &b[r.start * 4..r.end * 4], out);
    })
}

/// Conjugates of `n` quaternions, `(n, 4)`.
///
/// # Errors
/// [`Error::Length`] if the slices differ in length.
pub fn conjugate<T: Real>(q: &[T], out: &mut [T]) -> Result<(), Error> {
    check_length("out", q.len(), out.len())?;
    rows(q.len() / 4, 1, out, 4, |r, out| {
        for (q, out) in q[r.start * 4..r.end * 4].chunks_exact(4).zip(out.chunks_exact_mut(4)) {
            out.copy_from_slice(&conjugate_one([q[0], q[1], q[2], q[3]]));
        }
    })
}

/// `n` quaternions scaled to length 1, `(n, 4)`; NaN where the length is 0 or NaN.
///
/// # Errors
/// [`Error::Length`] if the slices differ in length.
pub fn normalize<T: Real>(q: &[T], out: &mut [T]) -> Result<(), Error> {
    check_length("out", q.len(), out.len())?;
    rows(q.len() / 4, 2, out, 4, |r, out| normalize_rows(&q[r.start * 4..r.end * 4], out))
}

/// Rotation angles between `n` pairs of rotations, in `[0, π]` radians: `(n, 4)`, `(n, 4)` → `(n)`.
///
/// # Errors
/// [`Error::Length`] if the lengths of slices do not agree.
pub fn geodesic_distance<T: Real>(a: &[T], b: &[T], out: &mut [T]) -> Result<(), Error> {
    check_length("b", a.len(), b.len())?;
    check_length("out", a.len() / 4, out.len())?;
    rows(out.len(), 4, out, 1, |r, out| {
        distance_rows(&a[r.start * 4..r.end * 4], &b[r.start * 4..r.end * 4], out);
    })
}

/// Quaternion logarithms, half the rotation vectors: `(n, 4)` → `(n, 3)`.
///
/// # Errors
/// [`Error::Length`] if the lengths of slices do not agree.
pub fn log<T: Real>(q: &[T], out: &mut [T]) -> Result<(), Error> {
    check_length("out", q.len() / 4 * 3, out.len())?;
    rows(q.len() / 4, 4, out, 3, |r, out| log_rows(&q[r.start * 4..r.end * 4], out))
}

/// Quaternion exponentials of half rotation vectors: `(n, 3)` → `(n, 4)`.
///
/// # Errors
/// [`Error::Length`] if the lengths of slices do not agree.
pub fn exp<T: Real>(v: &[T], out: &mut [T]) -> Result<(), Error> {
    check_length("out", v.len() / 3 * 4, out.len())?;
    rows(v.len() / 3, 4, out, 4, |r, out| {
        let v = &v[r.start * 3..r.end * 3];
        exp_rows(v, out);
        for (v, out) in v.chunks_exact(3).zip(out.chunks_exact_mut(4)) {
            let large = v.iter().fold(T::ZERO, |m, &x| m.max(x.abs())) > T::SIN_COS_LIMIT * T::HALF;
            if large {
                out.copy_from_slice(&exp_far([v[0], v[1], v[2]]));
            }
        }
    })
}

/// [`exp_one`] for angles beyond the range of the vectorised sine.
#[cold]
#[expect(
    clippy::disallowed_methods,
    reason = "only libm reduces large arguments exactly; rare, and not in a hot loop"
)]
fn exp_far<T: Real>(v: [T; 3]) -> [T; 4] {
    let v = v.map(T::to_f64);
    let angle = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    let (sine, cosine) = f64::sin_cos(angle);
    let factor = sine / angle;
    [cosine, v[0] * factor, v[1] * factor, v[2] * factor].map(T::from_f64)
}
