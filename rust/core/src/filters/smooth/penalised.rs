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
use crate::simd::multiversion;
use std::ops::Range;

/// The highest order of differences.
pub(super) const HIGHEST: usize = 3;

/// Columns that are solved side by side: each row of their equations waits for the one before.
pub(super) const LANES: usize = 4;

/// Frames after which it is asked whether to stop.
const PIECE: usize = 1 << 16;

/// A number of each column.
type Lane = [f64; LANES];

/// Of a row of equations, what the way back needs: the solution of the way forth, and the factor's entries below its diagonal.
pub(super) type Row = [Lane; 1 + HIGHEST];

/// Coefficients of the differences of an order, the earliest first.
const fn differences(order: usize) -> [f64; HIGHEST + 1] {
    match order {
        1 => [-1.0, 1.0, 0.0, 0.0],
        2 => [1.0, -2.0, 1.0, 0.0],
        _ => [-1.0, 3.0, -3.0, 1.0],
    }
}

/// Smooths columns of one length, at least 2, in place, each with differences of its own order.
///
/// `variances` are one over the weights, all 1 if there are none; `softness` has a number for each difference, and is as long as the
/// column. A column has the fewer rows of equations the higher its order: what is missing is filled up with rows that change nothing.
/// `rows` is memory, one for each frame.
pub(super) fn penalised(
    orders: [usize; LANES],
    mut columns: [&mut [f64]; LANES],
    variances: Option<&[f64]>,
    softness: [&[f64]; LANES],
    rows: &mut [Row],
    interrupt: &Interrupt,
) -> Result<(), Error> {
    let frames = columns[0].len();
    let rows = &mut rows[..frames - 1];
    let whole = frames.saturating_sub(HIGHEST);
    let z = columns.each_ref().map(|column| &**column);
    let mut forth = Forth::new(orders);
    for t in 0..HIGHEST {
        forth.step(
            z.map(|z| z.get(t).copied().unwrap_or(0.0)),
            variances.map(|v| v.get(t).copied().unwrap_or(1.0)),
        );
    }
    for first in (0..whole).step_by(PIECE) {
        interrupt.check()?;
        eliminate(&mut forth, z, variances, softness, first..whole.min(first + PIECE), rows);
    }
    for t in whole..rows.len() {
        let active = orders.map(|order| if t + order < frames { 1.0 } else { 0.0 });
        let softness = std::array::from_fn(|lane| if active[lane] > 0.0 { softness[lane][t] } else { 1.0 });
        forth.step([0.0; LANES], variances.map(|_| 1.0));
        rows[t] = forth.row(softness, active);
    }
    let mut back = Back { steps: forth.steps, solution: [[0.0; LANES]; HIGHEST + 1] };
    for end in (1..=rows.len()).rev().step_by(PIECE) {
        interrupt.check()?;
        substitute(&mut back, &mut columns, variances, end.saturating_sub(PIECE)..end, rows);
    }
    for t in (0..HIGHEST).rev() {
        back.step([[0.0; LANES]; 1 + HIGHEST]);
        back.smooth(&mut columns, variances, t);
    }
    Ok(())
}

/// What goes from row to row on the way forth.
#[derive(Debug, Clone, Copy)]
struct Forth {
    steps: [Lane; HIGHEST + 1],
    /// The diagonal and the bands of `D W⁻¹ Dᵀ`.
    bands: [Lane; HIGHEST + 1],
    /// Data and variances of the frames of a difference.
    z: [Lane; HIGHEST + 1],
    variances: [f64; HIGHEST + 1],
    /// Of the rows before, from the last one back: the factor's entries below the diagonal, and the same times the pivot.
    factors: [[Lane; HIGHEST]; HIGHEST],
    weighed: [[Lane; HIGHEST]; HIGHEST],
    /// Solutions of these rows.
    solved: [Lane; HIGHEST],
}

impl Forth {
    fn new(orders: [usize; LANES]) -> Self {
        let all = orders.map(differences);
        let band = |k: usize| all.map(|steps| (0..=HIGHEST - k).map(|i| steps[i + k] * steps[i]).sum());
        Self {
            steps: std::array::from_fn(|i| all.map(|steps| steps[i])),
            bands: std::array::from_fn(band),
            z: [[0.0; LANES]; HIGHEST + 1],
            variances: [1.0; HIGHEST + 1],
            factors: [[[0.0; LANES]; HIGHEST]; HIGHEST],
            weighed: [[[0.0; LANES]; HIGHEST]; HIGHEST],
            solved: [[0.0; LANES]; HIGHEST],
        }
    }

    /// Takes the last frame of the next difference.
    #[inline(always)]
    fn step(&mut self, z: Lane, variance: Option<f64>) {
        self.z = [self.z[1], self.z[2], self.z[3], z];
        if let Some(variance) = variance {
            self.variances = [self.variances[1], self.variances[2], self.variances[3], variance];
            for k in 0..=HIGHEST {
                let mut band = [0.0; LANES];
                for i in 0..=HIGHEST - k {
                    for (l, band) in band.iter_mut().enumerate() {
                        *band += self.steps[i + k][l] * self.steps[i][l] * self.variances[i + k];
                    }
                }
                self.bands[k] = band;
            }
        }
    }

    /// Eliminates a row; where it is not active it says that its solution is 0.
    #[inline(always)]
    fn row(&mut self, softness: Lane, active: Lane) -> Row {
        let ([f, g, h], [a, b, c]) = (self.factors, self.weighed);
        let mut column = self.bands;
        let mut value = [0.0; LANES];
        for l in 0..LANES {
            for i in 0..=HIGHEST {
                value[l] += self.steps[i][l] * self.z[i][l];
            }
            // The row before comes last: it is waited for.
            column[0][l] += softness[l];
            column[0][l] -= h[2][l] * c[2][l];
            column[0][l] -= g[1][l] * b[1][l];
            column[0][l] -= f[0][l] * a[0][l];
            column[1][l] -= g[2][l] * b[1][l];
            column[1][l] -= f[1][l] * a[0][l];
            column[2][l] -= f[2][l] * a[0][l];
            value[l] -= h[2][l] * self.solved[2][l];
            value[l] -= g[1][l] * self.solved[1][l];
            value[l] -= f[0][l] * self.solved[0][l];
            column[0][l] = column[0][l] * active[l] + (1.0 - active[l]);
            value[l] *= active[l];
        }
        let (mut factor, mut weighed) = ([[0.0; LANES]; HIGHEST], [[0.0; LANES]; HIGHEST]);
        let mut row = [[0.0; LANES]; 1 + HIGHEST];
        for l in 0..LANES {
            let inverse = 1.0 / column[0][l];
            row[0][l] = value[l] * inverse;
            for k in 0..HIGHEST {
                weighed[k][l] = column[k + 1][l] * active[l];
                factor[k][l] = weighed[k][l] * inverse;
                row[k + 1][l] = factor[k][l];
            }
        }
        self.factors = [factor, f, g];
        self.weighed = [weighed, a, b];
        self.solved = [value, self.solved[0], self.solved[1]];
        row
    }
}

multiversion! {
    /// Eliminates rows of which all columns have one.
    fn eliminate(
        forth: &mut Forth, z: [&[f64]; LANES], variances: Option<&[f64]>, softness: [&[f64]; LANES],
        range: Range<usize>, rows: &mut [Row],
    ) {
        let mut here = *forth;
        let end = range.end + HIGHEST;
        let z = z.map(|z| &z[..end]);
        let softness = softness.map(|softness| &softness[..end]);
        let variances = variances.map(|variances| &variances[..end]);
        for t in range {
            let next = t + HIGHEST;
            here.step([z[0][next], z[1][next], z[2][next], z[3][next]], variances.map(|v| v[next]));
            let soft = [softness[0][t], softness[1][t], softness[2][t], softness[3][t]];
            rows[t] = here.row(soft, [1.0; LANES]);
        }
        *forth = here;
    }
}

/// What goes from row to row on the way back.
#[derive(Debug, Clone, Copy)]
struct Back {
    steps: [Lane; HIGHEST + 1],
    /// `u` of a row, and of those after it.
    solution: [Lane; HIGHEST + 1],
}

impl Back {
    #[inline(always)]
    fn step(&mut self, row: Row) {
        let [a, b, c, _] = self.solution;
        let mut value = row[0];
        for l in 0..LANES {
            value[l] -= row[3][l] * c[l];
            value[l] -= row[2][l] * b[l];
            value[l] -= row[1][l] * a[l];
        }
        self.solution = [value, a, b, c];
    }

    /// Takes from the frame that is [`HIGHEST`] after the row what is too rough.
    #[inline(always)]
    fn smooth(&self, columns: &mut [&mut [f64]; LANES], variances: Option<&[f64]>, frame: usize) {
        let variance = variances.and_then(|variances| variances.get(frame)).copied().unwrap_or(1.0);
        let mut roughness = [0.0; LANES];
        for i in 0..=HIGHEST {
            for (l, roughness) in roughness.iter_mut().enumerate() {
                *roughness += self.steps[i][l] * self.solution[HIGHEST - i][l];
            }
        }
        for l in 0..LANES {
            if let Some(x) = columns[l].get_mut(frame) {
                *x -= roughness[l] * variance;
            }
        }
    }
}

multiversion! {
    /// Solves eliminated rows from the last one on, and smooths the columns.
    fn substitute(
        back: &mut Back, columns: &mut [&mut [f64]; LANES], variances: Option<&[f64]>, range: Range<usize>, rows: &[Row],
    ) {
        let mut here = *back;
        for t in range.rev() {
            here.step(rows[t]);
            here.smooth(columns, variances, t + HIGHEST);
        }
        *back = here;
    }
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
        let mut columns = [z, &vec![0.0; z.len()], &vec![1.0; z.len()], z].map(<[f64]>::to_vec);
        let soft = [softness, &vec![1.0; order]].concat();
        let rough = vec![1e9; z.len()];
        let mut rows = vec![[[0.0; LANES]; 1 + HIGHEST]; z.len()];
        penalised(
            [order, 1, 2, 3],
            columns.each_mut().map(|column| &mut column[..]),
            Some(variances),
            [&soft, &rough, &rough, &rough],
            &mut rows,
            interrupt,
        )?;
        let [x, zeros, ones, _] = columns;
        assert!(zeros.iter().all(|&x| x == 0.0) && ones.iter().all(|&x| x == 1.0));
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
