//! Patches as cosine coefficients, and back.

use super::wiener::LANES;
use super::{APART, COEFFICIENTS, LENGTH};
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

    /// Adds the first patches of some that begin [`APART`] frames after each other, given by their coefficients, to the frames that they
    /// hold.
    pub(super) fn add_patches(&self, coefficients: &[[f64; LANES]], patches: usize, out: &mut [f64]) {
        add_patches(coefficients, &self.basis, patches, out);
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
    fn add_patches<T: Real>(
        coefficients: &[[T; LANES]], basis: &[[T; LENGTH]; COEFFICIENTS], patches: usize, out: &mut [T],
    ) {
        let coefficients = &coefficients[..COEFFICIENTS];
        for patch in 0..patches {
            let mut frames = [T::ZERO; LENGTH];
            for k in 0..COEFFICIENTS {
                let x = coefficients[k][patch];
                for l in 0..LENGTH {
                    frames[l] += x * basis[k][l];
                }
            }
            let out = &mut out[patch * APART..][..LENGTH];
            for l in 0..LENGTH {
                out[l] += frames[l];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cosines_are_orthonormal_and_come_back() {
        let cosines = Cosines::new();
        for k in 0..COEFFICIENTS {
            let mut column = vec![0.0; 9 + 2 * LENGTH + 2 * LANE];
            let mut coefficients = [[0.0; LANES]; COEFFICIENTS];
            coefficients[k][2] = 1.0;
            cosines.add_patches(&coefficients, 3, &mut column);
            let first = 2 * APART;
            assert!(column[..first].iter().chain(&column[first + LENGTH..]).all(|&x| x == 0.0));
            let mut planes = vec![vec![0.0; LANE]; COEFFICIENTS];
            let mut rows = planes.iter_mut();
            cosines.of_all(&column, std::array::from_fn(|_| &mut rows.next().expect("as many planes")[..]));
            for (other, plane) in planes.iter().enumerate() {
                assert!((plane[first] - f64::from(u8::from(other == k))).abs() < 1e-14);
            }
        }
    }
}
