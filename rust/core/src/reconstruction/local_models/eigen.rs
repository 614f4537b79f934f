//! Eigenvectors of symmetric matrices of up to some hundred rows: Householder reflections to tridiagonal form, then
//! Francis' implicit QL steps with Wilkinson's shift (Golub and Van Loan, Matrix Computations, 8.3). Jacobi's method
//! takes ten times as long.

use super::dense::Matrix;
use crate::Error;
use crate::parallel::Interrupt;
use crate::simd::multiversion;

/// Largest number of steps per eigenvalue; two are usual.
const STEPS: usize = 40;

/// Eigenvalues and, in rows, the eigenvectors.
#[derive(Debug)]
pub(super) struct Eigen {
    pub(super) values: Vec<f64>,
    pub(super) vectors: Matrix,
}

/// All eigenvalues of a symmetric matrix, in descending order, with their eigenvectors.
pub(super) fn eigen(mut matrix: Matrix, interrupt: &Interrupt) -> Result<Eigen, Error> {
    let n = matrix.columns();
    let mut vectors = Matrix::new(n, n);
    for i in 0..n {
        vectors.set(i, i, 1.0);
    }
    let (mut values, mut off_diagonal) = tridiagonal(&mut matrix, &mut vectors, interrupt)?;
    diagonal(&mut values, &mut off_diagonal, &mut vectors, interrupt)?;
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&a, &b| values[b].total_cmp(&values[a]));
    let mut sorted = Matrix::new(n, n);
    for (row, &from) in sorted.rows_mut().zip(&order) {
        let width = row.len();
        row.copy_from_slice(&vectors.data()[from * width..][..width]);
    }
    Ok(Eigen { values: order.iter().map(|&i| values[i]).collect(), vectors: sorted })
}

/// Reduces to tridiagonal form and returns the diagonal and the off-diagonal. `vectors` are reflected from the left.
fn tridiagonal(
    matrix: &mut Matrix,
    vectors: &mut Matrix,
    interrupt: &Interrupt,
) -> Result<(Vec<f64>, Vec<f64>), Error> {
    let (n, width) = (matrix.columns(), matrix.width());
    let mut off_diagonal = vec![0.0; n];
    let mut normal = vec![0.0; width];
    let mut image = vec![0.0; width];
    for k in 0..n.saturating_sub(2) {
        interrupt.check()?;
        normal.fill(0.0);
        normal[k + 1..n].copy_from_slice(&matrix.data()[k * width + k + 1..k * width + n]);
        // Householder reflection that zeroes row k beyond the off-diagonal element.
        let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
        if length == 0.0 {
            continue;
        }
        off_diagonal[k] = -length.copysign(normal[k + 1]);
        normal[k + 1] -= off_diagonal[k];
        let scale = (2.0 / normal.iter().map(|x| x * x).sum::<f64>()).sqrt();
        for x in &mut normal {
            *x *= scale;
        }
        // A − v wᵀ − w vᵀ with w = A v − ½ (vᵀ A v) v, where |v|² = 2.
        image.fill(0.0);
        combine(&matrix.data()[(k + 1) * width..], &normal[k + 1..n], &mut image);
        let half = 0.5 * image[k + 1..n].iter().zip(&normal[k + 1..n]).map(|(a, b)| a * b).sum::<f64>();
        for (x, v) in image.iter_mut().zip(&normal) {
            *x -= half * v;
        }
        let rows = &mut matrix.data_mut()[(k + 1) * width..];
        subtract(rows, &normal[k + 1..n], &image);
        subtract(rows, &image[k + 1..n], &normal);
        image.fill(0.0);
        combine(&vectors.data()[(k + 1) * width..], &normal[k + 1..n], &mut image);
        subtract(&mut vectors.data_mut()[(k + 1) * width..], &normal[k + 1..n], &image);
    }
    if n > 1 {
        off_diagonal[n - 2] = matrix.at(n - 2, n - 1);
    }
    Ok(((0..n).map(|i| matrix.at(i, i)).collect(), off_diagonal))
}

multiversion! {
    /// Adds multiples of rows to `sum`.
    fn combine(rows: &[f64], factors: &[f64], sum: &mut [f64]) {
        let width = sum.len();
        for (row, factor) in rows.chunks_exact(width).zip(factors) {
            for j in 0..width {
                sum[j] += *factor * row[j];
            }
        }
    }
}

multiversion! {
    /// Subtracts multiples of `other` from rows.
    fn subtract(rows: &mut [f64], factors: &[f64], other: &[f64]) {
        let width = other.len();
        for (row, factor) in rows.chunks_exact_mut(width).zip(factors) {
            for j in 0..width {
                row[j] -= *factor * other[j];
            }
        }
    }
}

/// Diagonalises a tridiagonal matrix; the rows of `vectors` are rotated along with it.
fn diagonal(
    values: &mut [f64],
    off_diagonal: &mut [f64],
    vectors: &mut Matrix,
    interrupt: &Interrupt,
) -> Result<(), Error> {
    let n = values.len();
    let size = values.iter().chain(&*off_diagonal).fold(0.0_f64, |size, x| size.max(x.abs()));
    let enough = f64::EPSILON * size;
    for low in 0..n {
        for _ in 0..STEPS {
            interrupt.check()?;
            let Some(high) = (low..n).find(|&i| i == n - 1 || off_diagonal[i].abs() <= enough) else { break };
            if high == low {
                break;
            }
            // Wilkinson's shift, then a sweep of Givens rotations from `high` to `low` that chases the bulge.
            let ahead = (values[low + 1] - values[low]) / (2.0 * off_diagonal[low]);
            let root = (ahead * ahead + 1.0).sqrt().copysign(ahead);
            let mut bulge = values[high] - values[low] + off_diagonal[low] / (ahead + root);
            let (mut sine, mut cosine, mut moved) = (1.0, 1.0, 0.0);
            let mut whole = true;
            for i in (low..high).rev() {
                let (f, b) = (sine * off_diagonal[i], cosine * off_diagonal[i]);
                let length = (f * f + bulge * bulge).sqrt();
                off_diagonal[i + 1] = length;
                if length == 0.0 {
                    values[i + 1] -= moved;
                    off_diagonal[high] = 0.0;
                    whole = false;
                    break;
                }
                (sine, cosine) = (f / length, bulge / length);
                let above = values[i + 1] - moved;
                let turn = (values[i] - above) * sine + 2.0 * cosine * b;
                moved = sine * turn;
                values[i + 1] = above + moved;
                bulge = cosine * turn - b;
                let width = vectors.width();
                let (upper, lower) = vectors.data_mut().split_at_mut((i + 1) * width);
                rotate(&mut upper[i * width..], &mut lower[..width], cosine, sine);
            }
            if whole {
                values[low] -= moved;
                off_diagonal[low] = bulge;
                off_diagonal[high] = 0.0;
            }
        }
    }
    Ok(())
}

multiversion! {
    /// Rotates two rows in their plane.
    fn rotate(a: &mut [f64], b: &mut [f64], cosine: f64, sine: f64) {
        for (a, b) in a.iter_mut().zip(b) {
            let (before, after) = (*a, *b);
            *a = cosine * before - sine * after;
            *b = sine * before + cosine * after;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(n: usize, entry: impl Fn(usize, usize) -> f64) {
        let mut matrix = Matrix::new(n, n);
        for i in 0..n {
            for j in 0..n {
                matrix.set(i, j, entry(i, j));
            }
        }
        let size = (0..n)
            .flat_map(|i| (0..n).map(move |j| (i, j)))
            .fold(1e-300, |s: f64, (i, j)| s.max(entry(i, j).abs()));
        let found = eigen(matrix, &Interrupt::new()).expect("nobody interrupts");
        assert!(found.values.windows(2).all(|pair| pair[0] >= pair[1]));
        for a in 0..n {
            for b in 0..n {
                let product: f64 = (0..n).map(|i| found.vectors.at(a, i) * found.vectors.at(b, i)).sum();
                assert!((product - f64::from(u8::from(a == b))).abs() < 1e-13, "{n}: {a} {b} {product}");
                let image: f64 = (0..n).map(|i| entry(b, i) * found.vectors.at(a, i)).sum();
                let error = image - found.values[a] * found.vectors.at(a, b);
                assert!(error.abs() < 1e-13 * size * n as f64, "{n}: {a} {b} {error}");
            }
        }
    }

    #[test]
    fn vectors_are_orthonormal_and_diagonalise() {
        for n in [1, 2, 3, 7, 16, 33, 64] {
            check(n, |i, j| ((i * j + i + j) % 7) as f64 + if i == j { 3.0 } else { 0.0 });
            check(n, |i, j| if i == j { 2.0 } else { 0.0 });
            check(n, |_, _| 0.0);
            check(n, |_, _| 1.0);
            check(n, |i, j| 1e-9 * (i as f64 - 1.3) * (j as f64 - 1.3));
        }
    }
}
