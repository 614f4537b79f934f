//! Squared distances of segments.
//!
//! Squares are added in lanes, and the lanes in a tree, in one order at every level. All terms are positive, so that a sum of
//! `n` terms is exact to `n / 16 + 7` roundings, relative to itself.

use super::Segments;
use crate::Real;
use crate::simd::multiversion;

/// Sums that grow side by side.
pub(super) const LANES: usize = 16;

/// Passages whose middles lie side by side.
pub(super) const TILE: usize = 64;

/// A segment to which others are compared.
#[derive(Debug, Clone)]
pub struct Probe<T> {
    values: Vec<T>,
    /// 1 for those of the last [`LANES`] numbers that lie beyond the last whole group of lanes, else 0.
    rest: [T; LANES],
    /// Whether there is such a rest.
    ragged: bool,
}

impl<T: Real> Probe<T> {
    /// A copy of a segment.
    #[must_use]
    pub fn new(values: &[T]) -> Self {
        let mut probe = Self { values: Vec::new(), rest: [T::ZERO; LANES], ragged: false };
        probe.set(values);
        probe
    }

    /// Takes on another segment.
    pub fn set(&mut self, values: &[T]) {
        self.values.clear();
        self.values.extend_from_slice(values);
        self.ragged = !values.len().is_multiple_of(LANES);
        let counted = LANES - values.len() % LANES;
        for (lane, rest) in self.rest.iter_mut().enumerate() {
            *rest = if lane < counted { T::ZERO } else { T::ONE };
        }
    }

    /// Whether all its numbers are finite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.values.iter().all(|value| value.is_finite())
    }
}

/// Adds the upper half of the lanes to the lower.
#[inline(always)]
fn fold<T: Real, const N: usize, const H: usize>(lanes: [T; N]) -> [T; H] {
    let mut half = [T::ZERO; H];
    for lane in 0..H {
        half[lane] = lanes[lane] + lanes[lane + H];
    }
    half
}

/// Adds the squares of differences to the lanes.
#[inline(always)]
fn step<T: Real>(
    sums: [T; LANES],
    group: &[T; LANES],
    values: &[T; LANES],
    shares: &[T; LANES],
) -> [T; LANES] {
    let mut grown = [T::ZERO; LANES];
    for lane in 0..LANES {
        let difference = (group[lane] - values[lane]) * shares[lane];
        grown[lane] = sums[lane] + difference * difference;
    }
    grown
}

/// The squared distance of a segment to one that has as many numbers.
#[inline(always)]
fn square<T: Real>(segment: &[T], probe: &Probe<T>) -> T {
    let values = &probe.values[..segment.len()];
    let mut sums = [T::ZERO; LANES];
    let (groups, value_groups) = (segment.as_chunks::<LANES>().0, values.as_chunks::<LANES>().0);
    let value_groups = &value_groups[..groups.len()];
    let mut i = 0;
    while i < groups.len() {
        sums = step(sums, &groups[i], &value_groups[i], &[T::ONE; LANES]);
        i += 1;
    }
    if probe.ragged {
        sums = match (segment.last_chunk::<LANES>(), values.last_chunk::<LANES>()) {
            (Some(group), Some(values)) => step(sums, group, values, &probe.rest),
            _ => step(sums, &padded(segment), &padded(values), &[T::ONE; LANES]),
        };
    }
    total(sums)
}

/// The sum of the lanes.
#[inline(always)]
fn total<T: Real>(sums: [T; LANES]) -> T {
    let sums: [T; 8] = fold(sums);
    let sums: [T; 4] = fold(sums);
    let sums: [T; 2] = fold(sums);
    sums[0] + sums[1]
}

/// A few numbers and zeros.
#[inline(always)]
fn padded<T: Real>(numbers: &[T]) -> [T; LANES] {
    let mut padded = [T::ZERO; LANES];
    let mut i = 0;
    while i < numbers.len() {
        padded[i % LANES] = numbers[i];
        i += 1;
    }
    padded
}

multiversion! {
    /// Squared distances to segments of which each begins `dims` numbers after the one before.
    fn squares_along<T: Real>(rows: &[T], dims: usize, probe: &Probe<T>, out: &mut [T]) {
        let width = probe.values.len();
        for i in 0..out.len() {
            out[i] = square(&rows[i * dims..i * dims + width], probe);
        }
    }
}

multiversion! {
    /// Squared distances to segments that begin at the given rows.
    pub(crate) fn squares_of<T: Real>(rows: &[T], dims: usize, firsts: &[u32], probe: &Probe<T>, out: &mut [T]) {
        let width = probe.values.len();
        let firsts = &firsts[..out.len()];
        for i in 0..out.len() {
            let first = firsts[i] as usize * dims;
            out[i] = square(&rows[first..first + width], probe);
        }
    }
}

/// Squared distances to segments of which each begins `dims` numbers after the one before.
pub(super) fn in_sequence<T: Real>(rows: &[T], dims: usize, probe: &Probe<T>, out: &mut [T]) {
    squares_along(rows, dims, probe, out);
}

/// Squared distances to segments that begin at the given poses.
pub(super) fn scattered<T: Real>(
    segments: &Segments<'_, T>,
    firsts: &[u32],
    probe: &Probe<T>,
    out: &mut [T],
) {
    squares_of(segments.features(), segments.dims(), firsts, probe, out);
}

multiversion! {
    /// Squared distances of [`TILE`] vectors, the first numbers of which come first, to one.
    pub(super) fn tile<T: Real>(numbers: &[T], vector: &[T], out: &mut [T]) {
        let out = &mut out[..TILE];
        out.fill(T::ZERO);
        // Four at once: loads and stores of the sums would take longer than they do.
        for j in 0..vector.len() / 4 {
            let at = 4 * j * TILE;
            let [a, b, c, d] = [0, 1, 2, 3].map(|k| &numbers[at + k * TILE..at + (k + 1) * TILE]);
            let [x, y, z, w] = [vector[4 * j], vector[4 * j + 1], vector[4 * j + 2], vector[4 * j + 3]];
            for i in 0..TILE {
                let (p, q, r, s) = (a[i] - x, b[i] - y, c[i] - z, d[i] - w);
                out[i] += (p * p + q * q) + (r * r + s * s);
            }
        }
    }
}

multiversion! {
    /// Products of a pose with the vectors of a basis.
    pub(super) fn products<T: Real>(basis: &[T], pose: &[T], out: &mut [T]) {
        let dims = pose.len();
        for k in 0..out.len() {
            let vector = &basis[k * dims..(k + 1) * dims];
            let (vectors, poses) = (vector.as_chunks::<LANES>().0, pose.as_chunks::<LANES>().0);
            let mut sums = [T::ZERO; LANES];
            let mut i = 0;
            while i < poses.len() {
                let mut grown = [T::ZERO; LANES];
                for lane in 0..LANES {
                    grown[lane] = sums[lane] + vectors[i][lane] * poses[i][lane];
                }
                sums = grown;
                i += 1;
            }
            let mut total = total(sums);
            for i in LANES * poses.len()..dims {
                total += vector[i] * pose[i];
            }
            out[k] = total;
        }
    }
}
