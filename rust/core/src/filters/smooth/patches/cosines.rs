//! Patches as cosine coefficients, and back.

use super::{COEFFICIENTS, LENGTH};
use crate::Real;
use crate::simd::multiversion;
use std::f64::consts::PI;

/// Half of a patch: cosines about its middle are even or odd.
const HALF: usize = LENGTH / 2;

/// Coefficients of either kind.
const KIND: usize = COEFFICIENTS / 2;

/// Patches that are transformed together.
const LANE: usize = 8;

/// Orthonormal cosines over the frames of a patch, from the lowest frequency on.
#[derive(Debug)]
pub(super) struct Cosines {
    /// By coefficient, then by frame.
    basis: [[f64; LENGTH]; COEFFICIENTS],
}

impl Cosines {
    pub(super) fn new() -> Self {
        let length = LENGTH as f64;
        let cosine = |k: usize, l: usize| {
            let scale = if k == 0 { (1.0 / length).sqrt() } else { (2.0 / length).sqrt() };
            scale * Real::sin_cos(PI * (k * (2 * l + 1)) as f64 / (2.0 * length)).1
        };
        Self { basis: std::array::from_fn(|k| std::array::from_fn(|l| cosine(k, l))) }
    }

    /// Coefficients of all patches of a column, a plane for each: that at `i` is of the patch that begins at `i`. The planes may
    /// be padded by up to [`LENGTH`] frames less one.
    pub(super) fn of_all(&self, column: &[f64], planes: [&mut [f64]; COEFFICIENTS]) {
        transform(column, &self.basis, planes);
    }

    /// Coefficients of one patch.
    pub(super) fn of_one(&self, column: &[f64], out: &mut [f64]) {
        for (x, cosine) in out.iter_mut().zip(&self.basis) {
            *x = column.iter().zip(cosine).map(|(x, cosine)| x * cosine).sum();
        }
    }

    /// Adds the patch with the given coefficients.
    pub(super) fn add_patch(&self, coefficients: &[f64], out: &mut [f64; LENGTH]) {
        add_patch(coefficients, &self.basis, out);
    }
}

multiversion! {
    /// Coefficients of the patches of a column that begin at each frame, in whole lanes of patches; frames beyond its end are
    /// those before.
    fn transform<T: Real>(
        column: &[T], basis: &[[T; LENGTH]; COEFFICIENTS], planes: [&mut [T]; COEFFICIENTS],
    ) {
        for start in (0..planes[0].len()).step_by(LANE) {
            let column = &column[start..start + LENGTH + LANE - 1];
            for odd in 0..2 {
                let mut sums = [[T::ZERO; LANE]; KIND];
                for l in 0..HALF {
                    let a = &column[l..l + LANE];
                    let b = &column[LENGTH - 1 - l..LENGTH - 1 - l + LANE];
                    let mut both = [T::ZERO; LANE];
                    for i in 0..LANE {
                        both[i] = if odd == 0 { a[i] + b[i] } else { a[i] - b[i] };
                    }
                    for k in 0..KIND {
                        for i in 0..LANE {
                            sums[k][i] += basis[2 * k + odd][l] * both[i];
                        }
                    }
                }
                for k in 0..KIND {
                    planes[2 * k + odd][start..start + LANE].copy_from_slice(&sums[k]);
                }
            }
        }
    }
}

multiversion! {
    fn add_patch<T: Real>(coefficients: &[T], basis: &[[T; LENGTH]; COEFFICIENTS], out: &mut [T; LENGTH]) {
        let coefficients = &coefficients[..COEFFICIENTS];
        for k in 0..COEFFICIENTS {
            for l in 0..LENGTH {
                out[l] += coefficients[k] * basis[k][l];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cosines_are_orthonormal_and_all_ways_to_coefficients_agree() {
        let cosines = Cosines::new();
        let column: Vec<f64> = (0..64).map(|i| f64::from((i * i * 7 + i * 3) % 101)).collect();
        let mut planes = vec![vec![0.0; 32]; COEFFICIENTS];
        let mut rows = planes.iter_mut();
        cosines.of_all(&column, std::array::from_fn(|_| &mut rows.next().expect("as many planes")[..]));
        for start in 0..32 {
            let mut one = [0.0; COEFFICIENTS];
            cosines.of_one(&column[start..start + LENGTH], &mut one);
            for (k, x) in one.into_iter().enumerate() {
                assert!((planes[k][start] - x).abs() < 1e-11);
                let mut patch = [0.0; LENGTH];
                let unit: [f64; COEFFICIENTS] = std::array::from_fn(|i| f64::from(u8::from(i == k)));
                cosines.add_patch(&unit, &mut patch);
                let mut back = [0.0; COEFFICIENTS];
                cosines.of_one(&patch, &mut back);
                for (x, y) in back.iter().zip(unit) {
                    assert!((x - y).abs() < 1e-14);
                }
            }
        }
    }
}
