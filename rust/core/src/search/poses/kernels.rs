//! Squared distances of segments.
//!
//! Squares are summed in lanes, and the lanes in a tree, in the same order at every SIMD level. All terms are
//! positive, so a sum of `n` terms has a relative error of at most `n / 16 + 7` roundings.

use super::Segments;
use crate::Real;
use crate::simd::multiversion;

/// Number of running sums.
pub(super) const LANES: usize = 16;

/// Poses whose products are accumulated side by side.
const POSES: usize = 4;

/// Blocks whose middles are stored side by side.
pub(super) const TILE: usize = 64;

/// A segment that others are compared with.
#[derive(Debug, Clone)]
pub struct Probe<T> {
    values: Vec<T>,
    /// The whole groups of its values; then its last [`LANES`] values, or all of them padded with zeros; then a mask
    /// for these: 1 for values past the last whole group, 0 for the others.
    groups: Vec<Group<T>>,
}

/// Values that are loaded at once. Aligned, because a load across two cache lines takes twice as long. For the heap
/// only: memory of Python objects does not have this alignment.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
struct Group<T>([T; LANES]);

impl<T: Real> Probe<T> {
    /// Copies a segment.
    #[must_use]
    pub fn new(values: &[T]) -> Self {
        let mut probe = Self { values: Vec::new(), groups: Vec::new() };
        probe.set(values);
        probe
    }

    /// Replaces the segment.
    pub fn set(&mut self, values: &[T]) {
        self.values.clear();
        self.values.extend_from_slice(values);
        self.groups.clear();
        self.groups.extend(values.as_chunks::<LANES>().0.iter().map(|&group| Group(group)));
        let last = values.last_chunk::<LANES>().copied().unwrap_or_else(|| padded(values));
        let counted = if values.len() < LANES { 0 } else { LANES - values.len() % LANES };
        let rest = std::array::from_fn(|lane| if lane < counted { T::ZERO } else { T::ONE });
        self.groups.extend([Group(last), Group(rest)]);
    }

    /// Whether all values are finite.
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

/// Adds squared differences to the lanes. Differences so small that their squares lose digits are left out.
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
        let counted = if difference.abs() < T::LEAST_SQUARED { T::ZERO } else { difference };
        grown[lane] = sums[lane] + counted * counted;
    }
    grown
}

/// The lanes of the squared distance between a segment and a probe of the same length.
#[inline(always)]
fn lanes<T: Real>(segment: &[T], probe: &Probe<T>) -> [T; LANES] {
    let groups = segment.as_chunks::<LANES>().0;
    let (values, ends) = probe.groups.split_at(groups.len());
    let mut sums = [T::ZERO; LANES];
    let mut i = 0;
    while i < groups.len() {
        sums = step(sums, &groups[i], &values[i].0, &[T::ONE; LANES]);
        i += 1;
    }
    if segment.len().is_multiple_of(LANES) {
        return sums;
    }
    match segment.last_chunk::<LANES>() {
        Some(last) => step(sums, last, &ends[0].0, &ends[1].0),
        None => step(sums, &padded(segment), &ends[0].0, &ends[1].0),
    }
}

/// The sum of the lanes.
#[inline(always)]
fn total<T: Real>(sums: [T; LANES]) -> T {
    let sums: [T; 8] = fold(sums);
    let sums: [T; 4] = fold(sums);
    let sums: [T; 2] = fold(sums);
    sums[0] + sums[1]
}

/// Pads fewer than [`LANES`] values with zeros.
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
    /// Squared distances to segments that start `dims` values apart.
    fn squares_along<T: Real>(rows: &[T], dims: usize, probe: &Probe<T>, out: &mut [T]) {
        let width = probe.values.len();
        for i in 0..out.len() {
            out[i] = total(lanes(&rows[i * dims..i * dims + width], probe));
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
            out[i] = total(lanes(&rows[first..first + width], probe));
        }
    }
}

/// Squared distances to segments that start `dims` values apart.
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
    /// Squared distances between [`TILE`] vectors, stored coordinate by coordinate, and one vector.
    pub(super) fn tile<T: Real>(numbers: &[T], vector: &[T], out: &mut [T]) {
        let out = &mut out[..TILE];
        out.fill(T::ZERO);
        // Four coordinates per pass: loads and stores of the sums would take longer than the arithmetic.
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
    /// Products of poses with the [`LANES`] vectors of a basis, stored coordinate by coordinate.
    pub(super) fn products<T: Real>(basis: &[T], poses: &[T], out: &mut [T]) {
        let dims = basis.len() / LANES;
        let basis = basis.as_chunks::<LANES>().0;
        let (projections, rest) = out.as_chunks_mut::<LANES>();
        debug_assert!(rest.is_empty());
        let whole = projections.len() / POSES * POSES;
        let mut i = 0;
        while i < whole {
            let mut sums = [[T::ZERO; LANES]; POSES];
            let rows: [&[T]; POSES] = std::array::from_fn(|row| &poses[(i + row) * dims..(i + row + 1) * dims]);
            for j in 0..dims {
                for row in 0..POSES {
                    sums[row] = grow(sums[row], &basis[j], rows[row][j]);
                }
            }
            projections[i..i + POSES].copy_from_slice(&sums);
            i += POSES;
        }
        while i < projections.len() {
            let mut sums = [T::ZERO; LANES];
            for j in 0..dims {
                sums = grow(sums, &basis[j], poses[i * dims + j]);
            }
            projections[i] = sums;
            i += 1;
        }
    }
}

/// Adds the product of a vector and a scalar.
#[inline(always)]
fn grow<T: Real>(sums: [T; LANES], vector: &[T; LANES], number: T) -> [T; LANES] {
    let mut grown = [T::ZERO; LANES];
    for lane in 0..LANES {
        grown[lane] = sums[lane] + vector[lane] * number;
    }
    grown
}
