//! Patch distances of the candidates, and the most similar ones.

use super::Means;
use super::kernels::add;
use crate::filters::nonlocal_pose_means::{Distance, Reach, Weights};

/// Exponents or weights of candidates: for each lag, one column per weight.
pub(super) struct Candidates {
    pub(super) exponents: Vec<f64>,
    shares: Vec<f64>,
}

impl Candidates {
    pub(super) fn new(numbers: usize) -> Self {
        Self { exponents: vec![0.0; numbers], shares: vec![0.0; numbers] }
    }

    fn clear(&mut self) {
        self.exponents.fill(0.0);
        self.shares.fill(0.0);
    }

    /// Converts sums of distances to exponents; infinite where the sum of weights is 0.
    fn settle(&mut self, distance: Distance) {
        for (exponent, share) in self.exponents.iter_mut().zip(&self.shares) {
            let divisor = if distance == Distance::Mean { 3.0 * share } else { 1.0 };
            *exponent = if *share > 0.0 { *exponent / divisor } else { f64::INFINITY };
        }
    }
}

/// Number of weights per candidate.
pub(super) fn columns(weights: Weights, width: usize) -> usize {
    if weights == Weights::Joint { width.max(1) } else { 1 }
}

impl Means {
    /// Sums the frame distances over the patches of the filtered frame and of its candidates.
    pub(super) fn compare(&mut self) {
        let Reach { ahead, before, after, .. } = self.reach;
        let columns = self.columns();
        let Self { pairs, earlier, later, .. } = self;
        earlier.clear();
        for ago in ahead..=ahead + after + before {
            let [distances, shares] = pairs.ago(ago);
            add(&mut earlier.exponents, distances);
            add(&mut earlier.shares, shares);
        }
        later.clear();
        let lags = later.exponents.chunks_exact_mut(columns).zip(later.shares.chunks_exact_mut(columns));
        for (lag, (exponents, sums)) in (1..).zip(lags) {
            let place = (lag - 1) * columns..lag * columns;
            for ago in ahead - lag..=ahead - lag + after + before {
                let [distances, shares] = pairs.ago(ago);
                add(exponents, &distances[place.clone()]);
                add(sums, &shares[place.clone()]);
            }
        }
        earlier.settle(self.distance);
        later.settle(self.distance);
    }

    /// Sets the exponents of all but the most similar candidates to infinity.
    ///
    /// Ties go to the candidate nearer in time, then to the earlier one.
    pub(super) fn keep(&mut self, count: usize) {
        let columns = self.columns();
        let Self { earlier, later, sorted, .. } = self;
        for column in 0..columns {
            sorted.clear();
            for (later, candidates) in [&*earlier, &*later].into_iter().enumerate() {
                let exponents = candidates.exponents.iter().skip(column).step_by(columns);
                sorted.extend(exponents.enumerate().map(|(lag, &exponent)| (exponent, 2 * lag + later)));
            }
            if count >= sorted.len() {
                return;
            }
            let rest = match count.checked_sub(1) {
                Some(last) => {
                    let order = |a: &(f64, usize), b: &(f64, usize)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
                    sorted.select_nth_unstable_by(last, order).2
                }
                None => &mut sorted[..],
            };
            for &(_, place) in &*rest {
                let candidates = if place % 2 == 0 { &mut *earlier } else { &mut *later };
                candidates.exponents[place / 2 * columns + column] = f64::INFINITY;
            }
        }
    }
}
