//! Penalised least squares: numbers that are near the data, and whose differences of some order are small.
//!
//! C. H. Reinsch, "Smoothing by spline functions". With `D` for the differences of order `o`, weights `w` and softness `s`, the
//! minimum of `Σ w_t (x_t − z_t)² + Σ (Δᵒx)_t² / s_t` is
//!
//! ```text
//! x = z − W⁻¹ Dᵀ u,     (S + D W⁻¹ Dᵀ) u = D z
//! ```
//!
//! a system of `o` bands to either side of the diagonal, solved as `L D Lᵀ` in one way forth and one back.

use crate::Error;
use crate::parallel::Interrupt;

/// The highest order of differences.
pub(super) const HIGHEST: usize = 3;

/// Frames after which it is asked whether to stop.
const PIECE: usize = 1 << 16;

/// Memory of a solver, planes of at least as many numbers as the column has.
pub(super) struct Memory<'a> {
    /// The solution `u`.
    pub(super) solution: &'a mut [f64],
    /// One over the pivots.
    pub(super) pivots: &'a mut [f64],
    /// The factor's entries below its diagonal, one plane for each band.
    pub(super) lower: [&'a mut [f64]; HIGHEST],
}

/// Coefficients of the differences of order `O`, the earliest first.
const fn differences<const O: usize>() -> [f64; HIGHEST + 1] {
    match O {
        1 => [-1.0, 1.0, 0.0, 0.0],
        2 => [1.0, -2.0, 1.0, 0.0],
        _ => [-1.0, 3.0, -3.0, 1.0],
    }
}

/// Smooths a column in place. `variances` are one over the weights; `softness` has one number for each difference.
pub(super) fn penalised(
    order: usize,
    z: &mut [f64],
    variances: &[f64],
    softness: &[f64],
    memory: &mut Memory<'_>,
    interrupt: &Interrupt,
) -> Result<(), Error> {
    match order {
        1 => solve::<1>(z, variances, softness, memory, interrupt),
        2 => solve::<2>(z, variances, softness, memory, interrupt),
        _ => solve::<3>(z, variances, softness, memory, interrupt),
    }
}

fn solve<const O: usize>(
    z: &mut [f64],
    variances: &[f64],
    softness: &[f64],
    memory: &mut Memory<'_>,
    interrupt: &Interrupt,
) -> Result<(), Error> {
    let steps = differences::<O>();
    let rows = softness.len();
    let (z, variances) = (&mut z[..rows + O], &variances[..rows + O]);
    let Memory { solution, pivots, lower } = memory;
    let (u, pivots) = (&mut solution[..rows], &mut pivots[..rows]);
    // Of the rows before: the factor, times its pivot in `weighed`; `[j][k]` is `k` below the diagonal, `j` columns back.
    let mut before = [[0.0; HIGHEST + 1]; HIGHEST + 1];
    let mut weighed = [[0.0; HIGHEST + 1]; HIGHEST + 1];
    let mut solved = [0.0; HIGHEST + 1];
    for t in 0..rows {
        if t % PIECE == 0 {
            interrupt.check()?;
        }
        let mut column = [0.0; HIGHEST + 1];
        for k in 0..=O {
            for i in 0..=O - k {
                // Beyond the last row there is no entry, and what is computed here is not used.
                let at = (t + i + k).min(rows + O - 1);
                column[k] += steps[i + k] * steps[i] * variances[at];
            }
        }
        column[0] += softness[t];
        let mut value = 0.0;
        for i in 0..=O {
            value += steps[i] * z[t + i];
        }
        for j in 1..=O {
            for k in 0..=O - j {
                column[k] -= before[j][j + k] * weighed[j][j];
            }
            value -= before[j][j] * solved[j];
        }
        let inverse = 1.0 / column[0];
        let mut factor = [1.0; HIGHEST + 1];
        for k in 1..=O {
            factor[k] = column[k] * inverse;
            lower[k - 1][t] = factor[k];
        }
        for j in (2..=O).rev() {
            before[j] = before[j - 1];
            weighed[j] = weighed[j - 1];
            solved[j] = solved[j - 1];
        }
        before[1] = factor;
        weighed[1] = column;
        solved[1] = value;
        pivots[t] = inverse;
        u[t] = value;
    }
    let mut after = [0.0; HIGHEST + 1];
    for t in (0..rows).rev() {
        let mut value = u[t] * pivots[t];
        for k in 1..=O.min(rows - 1 - t) {
            value -= lower[k - 1][t] * after[k];
        }
        for k in (2..=O).rev() {
            after[k] = after[k - 1];
        }
        after[1] = value;
        u[t] = value;
    }
    for (t, (x, variance)) in z.iter_mut().zip(variances).enumerate() {
        let mut roughness = 0.0;
        for (i, step) in steps.iter().enumerate().take(O + 1) {
            if let Some(u) = t.checked_sub(i).and_then(|at| u.get(at)) {
                roughness += step * u;
            }
        }
        *x -= roughness * variance;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn smoothed_with(
        order: usize,
        z: &[f64],
        (variances, softness): (&[f64], &[f64]),
        interrupt: &Interrupt,
    ) -> Result<Vec<f64>, Error> {
        let mut planes = vec![vec![0.0; z.len()]; 5];
        let [solution, pivots, a, b, c] = &mut planes[..] else { return Ok(vec![]) };
        let mut memory = Memory { solution, pivots, lower: [a, b, c] };
        let mut x = z.to_vec();
        penalised(order, &mut x, variances, softness, &mut memory, interrupt)?;
        Ok(x)
    }

    fn smoothed(order: usize, z: &[f64], softness: f64) -> Vec<f64> {
        let (variances, softness) = (vec![1.0; z.len()], vec![softness; z.len() - order]);
        smoothed_with(order, z, (&variances, &softness), &Interrupt::new()).expect("nobody interrupts")
    }

    #[test]
    fn nothing_can_be_gained_on_the_minimum() {
        let n = 40;
        let z: Vec<f64> = (0..n).map(|t| f64::from(t * t * 7 % 23)).collect();
        let variances: Vec<f64> = (0..n).map(|t| 1.0 + f64::from(t % 5)).collect();
        for order in [1, 2, 3] {
            let softness: Vec<f64> = (0..n - 3).map(|t| 0.1 + f64::from(t % 7)).collect();
            let softness = [&softness[..], &[0.3, 2.0, 5.0][..3 - order]].concat();
            let cost = |x: &[f64]| {
                let data: f64 =
                    x.iter().zip(&z).zip(&variances).map(|((x, z), v)| (x - z) * (x - z) / v).sum();
                let mut differences = x.to_vec();
                for _ in 0..order {
                    differences = differences.windows(2).map(|pair| pair[1] - pair[0]).collect();
                }
                data + differences.iter().zip(&softness).map(|(d, s)| d * d / s).sum::<f64>()
            };
            let x = smoothed_with(order, &z, (&variances, &softness), &Interrupt::new())
                .expect("nobody interrupts");
            let least = cost(&x);
            assert!(least < 0.9 * cost(&z));
            // A parabola through three costs has its vertex where the solution is.
            for t in 0..x.len() {
                let [below, above] = [-1e-3, 1e-3].map(|step| {
                    let mut other = x.clone();
                    other[t] += step;
                    cost(&other)
                });
                assert!(below > least && above > least);
                assert!((above - below).abs() < 1e-6 * (above + below - 2.0 * least) + 1e-9);
            }
        }
    }

    #[test]
    fn who_is_asked_to_stop_stops() {
        let interrupt = Interrupt::new();
        interrupt.set();
        let z = [1.0, 2.0, 0.0, 4.0, 1.0];
        let result = smoothed_with(2, &z, (&[1.0; 5], &[1.0; 3]), &interrupt);
        assert!(matches!(result, Err(Error::Interrupted)));
    }

    #[test]
    fn polynomials_below_the_order_stay() {
        let line: Vec<f64> = (0..50).map(|t| 3.0 - 0.25 * f64::from(t)).collect();
        for order in [2, 3] {
            assert_eq!(smoothed(order, &line, 1e-10), line);
        }
    }

    #[test]
    fn the_stiffest_smoother_leaves_the_mean() {
        let z: Vec<f64> = (0..9).map(|t| f64::from(t * t % 5)).collect();
        let mean = z.iter().sum::<f64>() / 9.0;
        assert!(smoothed(1, &z, 1e-12).iter().all(|x| (x - mean).abs() < 1e-9));
    }
}
