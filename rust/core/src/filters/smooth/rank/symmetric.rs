//! Eigenvectors of symmetric matrices of some hundred rows: Householder's reflections to three bands, then QL steps.

use super::super::body::inner_product;
use crate::parallel::Interrupt;
use crate::simd::multiversion;
use crate::{Error, Real};

/// QL steps for one eigenvalue, at most; three are usual.
const STEPS: usize = 60;

/// Eigenvalues and eigenvectors of a symmetric matrix of `n` rows, in no order; the vectors are rows. Uses up the matrix.
pub(in super::super) fn eigen(
    matrix: &mut [f64],
    n: usize,
    interrupt: &Interrupt,
) -> Result<(Vec<f64>, Vec<f64>), Error> {
    let (mut diagonal, mut beside, mut vectors) = three_bands(matrix, n, interrupt)?;
    let norm = diagonal.iter().zip(&beside).map(|(d, e)| d.abs() + e.abs()).fold(0.0, f64::max);
    let small = f64::EPSILON * norm;
    for first in 0..n {
        interrupt.check()?;
        for _ in 0..STEPS {
            let last = (first..n - 1).find(|&i| beside[i].abs() <= small).unwrap_or(n - 1);
            if last == first {
                break;
            }
            step(&mut diagonal, &mut beside, &mut vectors, first, last, n);
        }
    }
    Ok((diagonal, vectors))
}

/// Diagonal, band beside it, and the rows of `V` for `V M Vᵀ` of three bands.
#[expect(clippy::type_complexity, reason = "three arrays of one length or its square")]
fn three_bands(
    matrix: &mut [f64],
    n: usize,
    interrupt: &Interrupt,
) -> Result<(Vec<f64>, Vec<f64>, Vec<f64>), Error> {
    let mut beside = vec![0.0; n];
    // Row k holds the normal of the mirror that clears row k.
    let mut normals = vec![0.0; n * n];
    let mut image = vec![0.0; n];
    for k in 0..n.saturating_sub(1) {
        interrupt.check()?;
        let (above, below) = matrix.split_at_mut((k + 1) * n);
        let normal = &mut normals[k * n..(k + 1) * n];
        normal[k + 1..].copy_from_slice(&above[k * n + k + 1..(k + 1) * n]);
        let length = inner_product(normal, normal).sqrt();
        beside[k] = if normal[k + 1] > 0.0 { -length } else { length };
        normal[k + 1] -= beside[k];
        let square = inner_product(normal, normal);
        if square <= 0.0 {
            continue;
        }
        // A unit normal v times √2: the mirror is 1 − v vᵀ.
        let scale = (2.0 / square).sqrt();
        for x in &mut *normal {
            *x *= scale;
        }
        for (x, row) in image[k + 1..].iter_mut().zip(below.chunks_exact(n)) {
            *x = inner_product(&row[k + 1..], &normal[k + 1..]);
        }
        let half = inner_product(&image[k + 1..], &normal[k + 1..]) * 0.5;
        for (x, v) in image[k + 1..].iter_mut().zip(&normal[k + 1..]) {
            *x -= half * v;
        }
        for (i, row) in below.chunks_exact_mut(n).enumerate() {
            let by = [normal[k + 1 + i], image[k + 1 + i]];
            take_both(&image[k + 1..], &normal[k + 1..], by, &mut row[k + 1..]);
        }
    }
    let diagonal = (0..n).map(|i| matrix[i * n + i]).collect();
    let mut vectors = vec![0.0; n * n];
    for i in 0..n {
        vectors[i * n + i] = 1.0;
    }
    for k in (0..n.saturating_sub(1)).rev() {
        let normal = &normals[k * n + k + 1..(k + 1) * n];
        for row in vectors[(k + 1) * n..].chunks_exact_mut(n) {
            let row = &mut row[k + 1..];
            let by = inner_product(row, normal);
            take(normal, by, row);
        }
    }
    Ok((diagonal, beside, vectors))
}

/// One implicit QL step between rows that no band joins to others.
fn step(d: &mut [f64], e: &mut [f64], vectors: &mut [f64], first: usize, last: usize, n: usize) {
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
        let (above, below) = vectors.split_at_mut((i + 1) * n);
        turn(&mut above[i * n..], &mut below[..n], [sine, cosine]);
    }
    d[first] -= shift;
    e[first] = g;
    e[last] = 0.0;
}

multiversion! {
    /// Takes away two rows, each times a factor.
    fn take_both<T: Real>(a: &[T], b: &[T], by: [T; 2], out: &mut [T]) {
        for ((x, a), b) in out.iter_mut().zip(a).zip(b) {
            *x -= by[0] * *a + by[1] * *b;
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
    /// Turns two rows into each other.
    fn turn<T: Real>(a: &mut [T], b: &mut [T], by: [T; 2]) {
        let [sine, cosine] = by;
        for (a, b) in a.iter_mut().zip(b) {
            let (x, y) = (*a, *b);
            *b = sine * x + cosine * y;
            *a = cosine * x - sine * y;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(n: usize, entry: impl Fn(usize, usize) -> f64) {
        let original: Vec<f64> = (0..n * n).map(|at| entry(at / n, at % n)).collect();
        let size = original.iter().fold(1.0, |size: f64, x| size.max(x.abs())) * n as f64;
        let (values, vectors) =
            eigen(&mut original.clone(), n, &Interrupt::new()).expect("nobody interrupts");
        for a in 0..n {
            for b in 0..n {
                let product: f64 = (0..n).map(|i| vectors[a * n + i] * vectors[b * n + i]).sum();
                assert!((product - f64::from(u8::from(a == b))).abs() < 1e-13 * n as f64);
                let image: f64 = (0..n).map(|i| original[a * n + i] * vectors[b * n + i]).sum();
                assert!((image - values[b] * vectors[b * n + a]).abs() < 1e-14 * size);
            }
        }
    }

    #[test]
    fn vectors_are_orthonormal_and_diagonalise() {
        check(1, |_, _| 3.0);
        check(2, |i, j| if i == j { 1.0 } else { 2.0 });
        check(6, |i, j| ((i * j + i + j) % 7) as f64);
        check(93, |i, j| ((i * j + i + j) % 31) as f64 - 12.0);
    }

    #[test]
    fn matrices_without_full_rank_are_no_trouble() {
        check(40, |_, _| 0.0);
        check(40, |i, j| ((i + 1) * (j + 1)) as f64);
        check(40, |i, j| f64::from(u8::from(i == j && i % 3 == 0)));
    }

    #[test]
    fn who_is_asked_to_stop_stops() {
        let interrupt = Interrupt::new();
        interrupt.set();
        assert!(eigen(&mut [2.0, 1.0, 1.0, 2.0], 2, &interrupt).is_err());
    }
}
