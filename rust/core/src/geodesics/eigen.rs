//! Eigenvectors of small symmetric matrices, by Jacobi's method.

/// Largest number of sweeps; each one squares the remaining off-diagonal elements.
const SWEEPS: usize = 30;

/// Rotates `matrix` until it is diagonal; calls `rotate` for each rotation of two rows.
fn diagonalise<const N: usize>(matrix: &mut [[f64; N]; N], mut rotate: impl FnMut(usize, usize, f64, f64)) {
    for _ in 0..SWEEPS {
        let mut rotated = false;
        for p in 0..N {
            for q in p + 1..N {
                let beside = matrix[p][q];
                let (a, b) = (matrix[p][p], matrix[q][q]);
                if beside.abs() <= f64::EPSILON * 0.5 * (a * b).abs().sqrt() || beside == 0.0 {
                    continue;
                }
                rotated = true;
                let theta = (b - a) / (2.0 * beside);
                let tangent = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
                let cosine = 1.0 / (tangent * tangent + 1.0).sqrt();
                let sine = tangent * cosine;
                for row in &mut *matrix {
                    (row[p], row[q]) = (cosine * row[p] - sine * row[q], sine * row[p] + cosine * row[q]);
                }
                rotate_rows(matrix, p, q, cosine, sine);
                rotate(p, q, cosine, sine);
            }
        }
        if !rotated {
            break;
        }
    }
}

fn rotate_rows<const N: usize>(matrix: &mut [[f64; N]; N], p: usize, q: usize, cosine: f64, sine: f64) {
    let (above, below) = matrix.split_at_mut(q);
    for (a, b) in above[p].iter_mut().zip(&mut below[0]) {
        (*a, *b) = (cosine * *a - sine * *b, sine * *a + cosine * *b);
    }
}

/// Eigenvalues in ascending order.
pub(super) fn values<const N: usize>(mut matrix: [[f64; N]; N]) -> [f64; N] {
    diagonalise(&mut matrix, |_, _, _, _| ());
    let mut values: [f64; N] = std::array::from_fn(|i| matrix[i][i]);
    values.sort_by(f64::total_cmp);
    values
}

/// Eigenvectors in ascending order of their eigenvalues; their largest component is positive.
pub(super) fn vectors<const N: usize>(mut matrix: [[f64; N]; N]) -> [[f64; N]; N] {
    let mut vectors: [[f64; N]; N] =
        std::array::from_fn(|i| std::array::from_fn(|j| if i == j { 1.0 } else { 0.0 }));
    diagonalise(&mut matrix, |p, q, cosine, sine| rotate_rows(&mut vectors, p, q, cosine, sine));
    let mut order: [usize; N] = std::array::from_fn(|i| i);
    order.sort_by(|&i, &j| matrix[i][i].total_cmp(&matrix[j][j]));
    order.map(|i| {
        let v = vectors[i];
        let largest = v.iter().fold(0.0_f64, |best, &x| if x.abs() > best.abs() { x } else { best });
        v.map(|x| if largest < 0.0 { -x } else { x })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vectors_belong_to_their_values() {
        let matrix = [[4.0, 1.0, 0.5, 0.0], [1.0, 3.0, 0.2, 0.1], [0.5, 0.2, 5.0, 0.3], [0.0, 0.1, 0.3, 1.0]];
        for (value, vector) in values(matrix).into_iter().zip(vectors(matrix)) {
            for (row, x) in matrix.iter().zip(vector) {
                let product: f64 = row.iter().zip(vector).map(|(a, b)| a * b).sum();
                assert!((product - value * x).abs() < 1e-14);
            }
        }
    }
}
