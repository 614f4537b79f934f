//! Eigenvectors of small symmetric matrices.

use crate::Error;
use crate::parallel::Interrupt;

/// Largest number of sweeps; each one squares the remaining off-diagonal elements.
const SWEEPS: usize = 30;

/// Eigenvectors of a symmetric matrix of `n` rows, as columns, by Jacobi's method. On return `matrix` has the
/// eigenvalues on its diagonal.
pub(crate) fn eigenvectors(matrix: &mut [f64], n: usize, interrupt: &Interrupt) -> Result<Vec<f64>, Error> {
    let mut vectors = vec![0.0; n * n];
    for i in 0..n {
        vectors[i * n + i] = 1.0;
    }
    for _ in 0..SWEEPS {
        let mut turned = false;
        for p in 0..n {
            interrupt.check()?;
            for q in p + 1..n {
                let beside = matrix[p * n + q];
                let (a, b) = (matrix[p * n + p], matrix[q * n + q]);
                if beside.abs() <= f64::EPSILON * 0.5 * (a * b).abs().sqrt() || beside == 0.0 {
                    continue;
                }
                turned = true;
                let theta = (b - a) / (2.0 * beside);
                let tangent = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
                let cosine = 1.0 / (tangent * tangent + 1.0).sqrt();
                let sine = tangent * cosine;
                rotate_columns(matrix, n, (p, q), (cosine, sine));
                rotate_rows(matrix, n, (p, q), (cosine, sine));
                rotate_columns(&mut vectors, n, (p, q), (cosine, sine));
            }
        }
        if !turned {
            break;
        }
    }
    Ok(vectors)
}

fn rotate_columns(matrix: &mut [f64], n: usize, (p, q): (usize, usize), (cosine, sine): (f64, f64)) {
    for row in matrix.chunks_exact_mut(n) {
        let (a, b) = (row[p], row[q]);
        row[p] = cosine * a - sine * b;
        row[q] = sine * a + cosine * b;
    }
}

fn rotate_rows(matrix: &mut [f64], n: usize, (p, q): (usize, usize), (cosine, sine): (f64, f64)) {
    let (above, below) = matrix.split_at_mut(q * n);
    for (a, b) in above[p * n..(p + 1) * n].iter_mut().zip(&mut below[..n]) {
        (*a, *b) = (cosine * *a - sine * *b, sine * *a + cosine * *b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vectors_are_orthonormal_and_diagonalise() {
        let n = 6;
        let entry = |i: usize, j: usize| ((i * j + i + j) % 7) as f64 + if i == j { 3.0 } else { 0.0 };
        let original: Vec<f64> = (0..n * n).map(|at| entry(at / n, at % n)).collect();
        let mut matrix = original.clone();
        let vectors = eigenvectors(&mut matrix, n, &Interrupt::new()).expect("nobody interrupts");
        for a in 0..n {
            for b in 0..n {
                let product: f64 = (0..n).map(|i| vectors[i * n + a] * vectors[i * n + b]).sum();
                assert!((product - f64::from(u8::from(a == b))).abs() < 1e-14);
                let image: f64 = (0..n).map(|i| original[a * n + i] * vectors[i * n + b]).sum();
                assert!((image - vectors[a * n + b] * matrix[b * n + b]).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn who_is_asked_to_stop_stops() {
        let interrupt = Interrupt::new();
        interrupt.set();
        assert!(matches!(eigenvectors(&mut [1.0, 0.5, 0.5, 2.0], 2, &interrupt), Err(Error::Interrupted)));
    }
}
