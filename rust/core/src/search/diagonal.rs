//! Distances between the patches along one diagonal.

use super::features::{Features, Joint, Kind};
use super::kernels::{self, LANES};
use crate::Real;
use std::ops::Range;

/// The patch distance: `√(Σ factor·square / Σ unit)` over offsets and joints. Each term is weighted with the product
/// of both samples' weights.
#[derive(Debug)]
pub(crate) struct Measure<T> {
    /// Frames of a patch before its centre.
    pub(crate) before: usize,
    /// Frames of a patch after its centre.
    pub(crate) after: usize,
    /// The joints that are compared.
    pub(crate) joints: Range<usize>,
    /// Weight of a squared difference, per joint.
    pub(crate) factors: Vec<T>,
    /// Weight of a pair of samples in the divisor, per joint.
    pub(crate) units: Vec<T>,
    /// Whether there is a divisor.
    pub(crate) averaged: bool,
}

impl<T: Real> Measure<T> {
    /// The same measure for vectors that are half rotation vectors: their squares are a quarter of the squared
    /// angles.
    pub(crate) fn halved(mut self, joints: &[Joint]) -> Self {
        for (factor, joint) in self.factors.iter_mut().zip(joints) {
            if joint.kind == Kind::Vector {
                *factor *= T::TWO * T::TWO;
            }
        }
        self
    }

    /// Patch length in frames.
    pub(crate) fn window(&self) -> usize {
        self.before + self.after + 1
    }

    /// The divisor for patches without missing samples.
    pub(crate) fn divisor(&self) -> f64 {
        if !self.averaged {
            return 1.0;
        }
        let units: f64 = self.units[self.joints.clone()].iter().map(|unit| unit.to_f64()).sum();
        units * self.window() as f64
    }
}

/// Scratch memory, reused from diagonal to diagonal.
#[derive(Debug, Default)]
pub(crate) struct Diagonal<T> {
    squares: Vec<T>,
    shares: Vec<T>,
    totals: Vec<T>,
    scratch: Vec<T>,
}

impl<T: Real> Diagonal<T> {
    /// Distances of the patches centred on the columns `at[0] + i` of `a` and `at[1] + i` of `b`, into `out`. They
    /// are infinite where no pair of samples can be compared. Planes must hold [`LANES`] columns more than the
    /// patches.
    ///
    /// A distance depends on its two patches only, to the last bit, and is symmetric in `a` and `b`.
    pub(crate) fn measure(
        &mut self,
        measure: &Measure<T>,
        a: &Features<'_, T>,
        b: &Features<'_, T>,
        at: [usize; 2],
        out: &mut [T],
    ) {
        let window = measure.window();
        let span = (out.len() + window - 1).next_multiple_of(LANES);
        let at = at.map(|at| at - measure.before);
        let (joints, factors) = (measure.joints.clone(), &measure.factors[..]);
        let Self { squares, shares, totals, scratch } = self;
        squares.resize(span, T::ZERO);
        if a.shares.is_some() {
            shares.resize(span, T::ZERO);
            totals.resize(out.len(), T::ZERO);
            let sums = [&mut squares[..], &mut shares[..]];
            kernels::shared_frame_distances(sums, a, b, at, joints, factors, &measure.units);
            kernels::sliding_sums(squares, scratch, window, out);
            kernels::sliding_sums(shares, scratch, window, totals);
            kernels::shared_roots(out, totals, measure.averaged);
        } else {
            kernels::frame_distances(squares, a, b, at, joints, factors);
            kernels::sliding_sums(squares, scratch, window, out);
            kernels::roots(out, T::from_f64(1.0 / measure.divisor()));
        }
    }
}
