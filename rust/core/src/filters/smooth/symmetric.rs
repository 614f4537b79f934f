//! Leading eigenvectors of symmetric matrices of some hundred rows: Householder's reflections to three bands, QL steps for the
//! eigenvalues, and inverse iteration for the vectors of the large ones.

use crate::parallel::Interrupt;
use crate::simd::multiversion;
use crate::{Error, Real};

/// QL steps for one eigenvalue, at most; three are usual.
const STEPS: usize = 60;

/// Steps of inverse iteration: after the first one a vector has all its digits, unless it began at right angles to itself.
const ITERATIONS: usize = 3;

/// A symmetric matrix that reflections have brought to three bands.
struct Bands {
    diagonal: Vec<f64>,
    /// The band beside it; its last number is 0.
    beside: Vec<f64>,
    /// Row `k` holds the normal of the mirror that clears row `k`, `√2` long.
    normals: Vec<f64>,
    /// Absolute values below this are roundings.
    small: f64,
}

/// Eigenvalues of a symmetric matrix of `n` rows that are larger than `above`, at least 0, and their vectors as rows, both from the
/// largest on. Uses up the matrix.
pub(super) fn leading(
    matrix: &mut [f64],
    n: usize,
    above: f64,
    interrupt: &Interrupt,
) -> Result<(Vec<f64>, Vec<f64>), Error> {
    let bands = Bands::new(matrix, n, interrupt)?;
    let mut values = bands.values(interrupt)?;
    values.retain(|&value| value > above);
    values.sort_by(|a, b| b.total_cmp(a));
    let mut vectors = vec![0.0; values.len() * n];
    for (i, &value) in values.iter().enumerate() {
        interrupt.check()?;
        let (before, rest) = vectors.split_at_mut(i * n);
        bands.vector(value, before, &mut rest[..n]);
    }
    for vector in vectors.chunks_exact_mut(n.max(1)) {
        for k in (0..n.saturating_sub(1)).rev() {
            let normal = &bands.normals[k * n + k + 1..(k + 1) * n];
            take(normal, inner_product(&vector[k + 1..], normal), &mut vector[k + 1..]);
        }
    }
    Ok((values, vectors))
}

impl Bands {
    fn new(matrix: &mut [f64], n: usize, interrupt: &Interrupt) -> Result<Self, Error> {
        let mut beside = vec![0.0; n];
        let mut normals = vec![0.0; n * n];
        let mut image = vec![0.0; n];
        for k in 0..n.saturating_sub(1) {
            interrupt.check()?;
            let (above, below) = matrix.split_at_mut((k + 1) * n);
            let normal = &mut normals[k * n + k + 1..(k + 1) * n];
            normal.copy_from_slice(&above[k * n + k + 1..(k + 1) * n]);
            let length = inner_product(normal, normal).sqrt();
            beside[k] = if normal[0] > 0.0 { -length } else { length };
            normal[0] -= beside[k];
            let square = inner_product(normal, normal);
            if square <= 0.0 {
                continue;
            }
            // A unit normal v times √2: the mirror is 1 − v vᵀ.
            let scale = (2.0 / square).sqrt();
            for x in &mut *normal {
                *x *= scale;
            }
            let image = &mut image[k + 1..];
            mirror(normal, image, &mut below[k + 1..], n);
        }
        let diagonal: Vec<f64> = (0..n).map(|i| matrix[i * n + i]).collect();
        let norm = diagonal.iter().zip(&beside).map(|(d, e)| d.abs() + e.abs()).fold(0.0, f64::max);
        Ok(Self { diagonal, beside, normals, small: f64::EPSILON * norm })
    }

    /// All eigenvalues, in no order.
    fn values(&self, interrupt: &Interrupt) -> Result<Vec<f64>, Error> {
        let n = self.diagonal.len();
        let (mut diagonal, mut beside) = (self.diagonal.clone(), self.beside.clone());
        for first in 0..n {
            interrupt.check()?;
            for _ in 0..STEPS {
                let last = (first..n - 1).find(|&i| beside[i].abs() <= self.small).unwrap_or(n - 1);
                if last == first {
                    break;
                }
                step(&mut diagonal, &mut beside, first, last);
            }
        }
        Ok(diagonal)
    }

    /// The unit vector of an eigenvalue, at right angles to those before, by inverse iteration.
    fn vector(&self, value: f64, before: &[f64], x: &mut [f64]) {
        let n = x.len();
        let factors = Factors::new(self, value);
        // Any vector will do, but not the same one for equal values.
        let mut random = 1 + before.len() as u64;
        for x in &mut *x {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            *x = (random >> 33) as f64 / f64::from(1_u32 << 31) - 0.5;
        }
        for _ in 0..ITERATIONS {
            factors.solve(x);
            // Lengths first, or what is taken away is infinite.
            normalize(x);
            for other in before.chunks_exact(n) {
                take(other, inner_product(x, other), x);
            }
            normalize(x);
        }
    }
}

/// Makes a vector one of length 1; it is not 0.
fn normalize(x: &mut [f64]) {
    let scale = 1.0 / inner_product(x, x).sqrt();
    for x in x {
        *x *= scale;
    }
}

/// What Gaussian elimination makes of three bands less an eigenvalue: rows change places where that keeps factors small.
struct Factors {
    /// One over the pivots, and the two numbers that stand right of each.
    rows: Vec<[f64; 3]>,
    /// How much of each row is taken away from the next one, and whether the two change places before.
    lower: Vec<(f64, bool)>,
}

impl Factors {
    fn new(bands: &Bands, value: f64) -> Self {
        let Bands { diagonal, beside, small, .. } = bands;
        let n = diagonal.len();
        let pivot = |x: f64| if x.abs() > *small { x } else { *small };
        let (mut rows, mut lower) = (Vec::with_capacity(n), Vec::with_capacity(n));
        let mut row = [diagonal[0] - value, beside[0]];
        for i in 1..n {
            let below = [beside[i - 1], diagonal[i] - value, beside[i]];
            if below[0].abs() > row[0].abs() {
                let factor = row[0] / below[0];
                rows.push([1.0 / pivot(below[0]), below[1], below[2]]);
                lower.push((factor, true));
                row = [row[1] - factor * below[1], -factor * below[2]];
            } else {
                let inverse = 1.0 / pivot(row[0]);
                let factor = below[0] * inverse;
                rows.push([inverse, row[1], 0.0]);
                lower.push((factor, false));
                row = [below[1] - factor * row[1], below[2]];
            }
        }
        rows.push([1.0 / pivot(row[0]), 0.0, 0.0]);
        Self { rows, lower }
    }

    fn solve(&self, x: &mut [f64]) {
        for (i, &(factor, changed)) in self.lower.iter().enumerate() {
            if changed {
                x.swap(i, i + 1);
            }
            x[i + 1] -= factor * x[i];
        }
        let mut after = [0.0; 2];
        for (x, row) in x.iter_mut().zip(&self.rows).rev() {
            *x = (*x - row[1] * after[0] - row[2] * after[1]) * row[0];
            after = [*x, after[0]];
        }
    }
}

/// One implicit QL step between rows that no band joins to others.
fn step(d: &mut [f64], e: &mut [f64], first: usize, last: usize) {
    let ahead = (d[first + 1] - d[first]) / (2.0 * e[first]);
    let root = (ahead * ahead + 1.0).sqrt();
    let mut g = d[last] - d[first] + e[first] / (ahead + if ahead < 0.0 { -root } else { root });
    let (mut sine, mut cosine, mut shift) = (1.0, 1.0, 0.0);
    for i in (first..last).rev() {
        let (f, b) = (sine * e[i], cosine * e[i]);
        let length = (f * f + g * g).sqrt();
        e[i + 1] = length;
        if length <= 0.0 {
            d[i + 1] -= shift;
            e[last] = 0.0;
            return;
        }
        (sine, cosine) = (f / length, g / length);
        g = d[i + 1] - shift;
        let way = (d[i] - g) * sine + 2.0 * cosine * b;
        shift = sine * way;
        d[i + 1] = g + shift;
        g = cosine * way - b;
    }
    d[first] -= shift;
    e[first] = g;
    e[last] = 0.0;
}

multiversion! {
    /// Applies the mirror `1 − v vᵀ` to both sides of a symmetric matrix: the last columns of rows of `n` numbers.
    fn mirror<T: Real>(normal: &[T], image: &mut [T], rows: &mut [T], n: usize) {
        let m = normal.len();
        let half = T::HALF;
        for (x, row) in image.iter_mut().zip(rows.chunks_mut(n)) {
            *x = sum_of_products(&row[..m], normal);
        }
        let shared = half * sum_of_products(image, normal);
        for (x, v) in image.iter_mut().zip(normal) {
            *x -= shared * *v;
        }
        let image = &image[..m];
        for (i, row) in rows.chunks_mut(n).enumerate().take(m) {
            let (a, b) = (normal[i], image[i]);
            let row = &mut row[..m];
            for j in 0..m {
                row[j] -= a * image[j] + b * normal[j];
            }
        }
    }
}

multiversion! {
    fn take<T: Real>(a: &[T], by: T, out: &mut [T]) {
        for (x, a) in out.iter_mut().zip(a) {
            *x -= by * *a;
        }
    }
}

multiversion! {
    /// Inner product, the same at every level.
    pub(super) fn inner_product<T: Real>(a: &[T], b: &[T]) -> T {
        sum_of_products(a, b)
    }
}

/// Inner product: partial sums side by side.
#[inline(always)]
fn sum_of_products<T: Real>(a: &[T], b: &[T]) -> T {
    /// Partial sums: two vectors of float64 at the widest level.
    const LANES: usize = 16;
    let (a, a_rest) = a.as_chunks::<LANES>();
    let (b, b_rest) = b.as_chunks::<LANES>();
    let mut sums = [T::ZERO; LANES];
    for (a, b) in a.iter().zip(b) {
        for i in 0..LANES {
            sums[i] += a[i] * b[i];
        }
    }
    let mut sum = T::ZERO;
    for x in sums {
        sum += x;
    }
    for (a, b) in a_rest.iter().zip(b_rest) {
        sum += *a * *b;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(n: usize, above: f64, entry: impl Fn(usize, usize) -> f64) -> usize {
        let original: Vec<f64> = (0..n * n).map(|at| entry(at / n, at % n)).collect();
        let size = original.iter().fold(1.0, |size: f64, x| size.max(x.abs())) * n as f64;
        let (values, vectors) =
            leading(&mut original.clone(), n, above, &Interrupt::new()).expect("nobody interrupts");
        assert!(values.is_sorted_by(|a, b| a >= b) && values.iter().all(|&value| value > above));
        for (a, first) in vectors.chunks_exact(n).enumerate() {
            for (b, vector) in vectors.chunks_exact(n).enumerate() {
                let product: f64 = first.iter().zip(vector).map(|(x, y)| x * y).sum();
                assert!((product - f64::from(u8::from(a == b))).abs() < 1e-13 * n as f64);
            }
            for (i, row) in original.chunks_exact(n).enumerate() {
                let image: f64 = row.iter().zip(first).map(|(x, y)| x * y).sum();
                assert!((image - values[a] * first[i]).abs() < 1e-14 * size);
            }
        }
        values.len()
    }

    #[test]
    fn vectors_are_orthonormal_and_diagonalise() {
        let all = f64::NEG_INFINITY;
        assert_eq!(check(1, all, |_, _| 3.0), 1);
        assert_eq!(check(2, all, |i, j| if i == j { 1.0 } else { 2.0 }), 2);
        assert_eq!(check(6, all, |i, j| ((i * j + i + j) % 7) as f64), 6);
        assert_eq!(check(93, all, |i, j| ((i * j + i + j) % 31) as f64 - 12.0), 93);
    }

    #[test]
    fn matrices_without_full_rank_are_no_trouble() {
        let all = f64::NEG_INFINITY;
        assert_eq!(check(40, all, |i, j| ((i + 1) * (j + 1)) as f64), 40);
        assert_eq!(check(40, all, |i, j| f64::from(u8::from(i == j && i % 3 == 0))), 40);
    }

    #[test]
    fn only_large_eigenvalues_are_found() {
        assert_eq!(check(40, 0.0, |_, _| 0.0), 0);
        assert_eq!(check(40, 0.5, |i, j| f64::from(u8::from(i == j && i % 3 == 0))), 14);
        assert_eq!(check(40, 12.5, |i, j| if i == j { i as f64 } else { 0.0 }), 27);
    }

    #[test]
    fn who_is_asked_to_stop_stops() {
        let interrupt = Interrupt::new();
        interrupt.set();
        assert!(leading(&mut [2.0, 1.0, 1.0, 2.0], 2, 0.0, &interrupt).is_err());
    }
}
