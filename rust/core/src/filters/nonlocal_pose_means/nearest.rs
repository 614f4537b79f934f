//! The most similar patches of each frame.

use super::kernels::{FARTHEST, SHIFT};
use super::means::Means;
use super::tile::{Piece, Side};
use crate::Real;

/// A candidate and how far it is.
#[derive(Debug, Clone, Copy)]
struct Candidate<T> {
    exponent: T,
    lag: usize,
    later: bool,
}

/// The `count` candidates with the smallest exponents, per frame, nearest first.
///
/// Among equals the candidate closer in time comes first, and the earlier before the later: candidates are offered in
/// that order, and a later offer must be strictly better.
#[derive(Debug)]
pub(super) struct Nearest<T> {
    count: usize,
    best: Vec<Vec<Candidate<T>>>,
}

impl<T: Real> Nearest<T> {
    pub(super) fn new(frames: usize, count: usize) -> Self {
        Self { count, best: vec![Vec::new(); frames] }
    }

    /// Offers the pairs of one lag; lags must come in increasing order.
    pub(super) fn offer(&mut self, lag: usize, piece: &Piece, exponents: &[T]) {
        for (side, later) in [(&piece.backward, false), (&piece.forward, true)] {
            let Some(Side { pairs, frames }) = side else { continue };
            for (frame, &exponent) in frames.clone().zip(&exponents[pairs.clone()]) {
                self.insert(frame, Candidate { exponent, lag, later });
            }
        }
    }

    fn insert(&mut self, frame: usize, candidate: Candidate<T>) {
        let best = &mut self.best[frame];
        if !candidate.exponent.is_finite() || candidate.exponent > T::from_f64(FARTHEST) {
            return;
        }
        if best.len() == self.count {
            match best.last() {
                Some(last) if candidate.exponent < last.exponent => best.pop(),
                _ => return,
            };
        }
        let place = best.partition_point(|kept| kept.exponent <= candidate.exponent);
        best.insert(place, candidate);
    }

    /// Adds the kept candidates to the means.
    pub(super) fn add_to(&self, means: &mut Means<'_, T>) {
        for (frame, best) in self.best.iter().enumerate() {
            for candidate in best.iter().filter(|candidate| candidate.exponent <= T::from_f64(FARTHEST)) {
                let weight = (T::from_f64(SHIFT) - candidate.exponent).exp();
                means.add_one(frame, candidate.lag, candidate.later, weight);
            }
        }
    }
}
