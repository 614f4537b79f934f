//! From weights to sums and means.

use super::LANE;
use crate::Real;
use crate::clip::Planes;
use crate::simd::multiversion;

multiversion! {
    /// Updates the largest weight and the total.
    pub(in super::super) fn note_weights<T: Real>(most: &mut [T], total: &mut [T], weights: &[T]) {
        let n = weights.len();
        let (most, total) = (&mut most[..n], &mut total[..n]);
        for i in 0..n {
            most[i] = most[i].max(weights[i]);
            total[i] += weights[i];
        }
    }
}

multiversion! {
    /// `sums += weights·values`, or `−=` with `sign = −1`.
    pub(in super::super) fn add_products<T: Real>(sums: &mut [T], weights: &[T], values: &[T], sign: T) {
        let n = sums.len();
        let (weights, values) = (&weights[..n], &values[..n]);
        for i in 0..n {
            sums[i] += sign * weights[i] * values[i];
        }
    }
}

/// The weights of a block of lags.
pub(in super::super) struct Lags<'a, T> {
    /// Index of the tile's first frame in the planes.
    pub(in super::super) at: usize,
    /// The first lag.
    pub(in super::super) first: usize,
    /// Number of lags.
    pub(in super::super) count: usize,
    /// Weights of later samples, one row per lag.
    pub(in super::super) forward: &'a Planes<T>,
    /// Weights of earlier samples, one row per lag.
    pub(in super::super) backward: &'a Planes<T>,
    /// Whether this block is the first of the sums.
    pub(in super::super) fresh: bool,
}

multiversion! {
    /// Adds, for each lag of a block, the weighted later and earlier samples of `N` planes.
    ///
    /// Samples outside the planes must have weight 0.
    pub(in super::super) fn accumulate<T: Real, const N: usize>(
        sums: [&mut [T]; N], planes: [&[T]; N], block: &Lags<'_, T>,
    ) {
        let Lags { at, first, count, forward, backward, fresh } = *block;
        let mut sums = sums;
        let length = planes[0].len();
        for start in (0..sums[0].len()).step_by(LANE) {
            let mut lane = [[T::ZERO; LANE]; N];
            for l in 0..count {
                let shift = first + l;
                let f = &forward.row(l)[start..start + LANE];
                let b = &backward.row(l)[start..start + LANE];
                let later = at + start + shift;
                let earlier = (at + start).wrapping_sub(shift);
                let inside = later + LANE <= length && earlier < length && earlier + LANE <= length;
                if inside {
                    let after: [&[T]; N] = std::array::from_fn(|n| &planes[n][later..later + LANE]);
                    let before: [&[T]; N] = std::array::from_fn(|n| &planes[n][earlier..earlier + LANE]);
                    for i in 0..LANE {
                        for n in 0..N {
                            lane[n][i] += f[i] * after[n][i] + b[i] * before[n][i];
                        }
                    }
                } else {
                    for (lane, plane) in lane.iter_mut().zip(&planes) {
                        for i in 0..LANE {
                            let after = plane.get(later + i).map_or(T::ZERO, |x| f[i] * *x);
                            let before = plane.get(earlier.wrapping_add(i)).map_or(T::ZERO, |x| b[i] * *x);
                            lane[i] += after + before;
                        }
                    }
                }
            }
            for (sums, lane) in sums.iter_mut().zip(&lane) {
                let sums = &mut sums[start..start + LANE];
                if fresh {
                    sums.copy_from_slice(lane);
                } else {
                    for i in 0..LANE {
                        sums[i] += lane[i];
                    }
                }
            }
        }
    }
}

multiversion! {
    /// Means in the chart: `(sums + own·x) / (total + own)`, into `sums`; `x` itself where the total weight is 0.
    pub(in super::super) fn settle<T: Real>(sums: &mut [T], x: &[T], total: &[T], own: &[T]) {
        let n = sums.len();
        let (x, total, own) = (&x[..n], &total[..n], &own[..n]);
        for i in 0..n {
            let weight = total[i] + own[i];
            let mean = (sums[i] + own[i] * x[i]) / weight;
            sums[i] = if weight > T::ZERO { mean } else { x[i] };
        }
    }
}

multiversion! {
    /// Means relative to the sample itself: `sums / (total + own)`, into `sums`; 0 where the total weight is 0.
    pub(in super::super) fn settle_local<T: Real>(sums: &mut [T], total: &[T], own: &[T]) {
        let n = sums.len();
        let (total, own) = (&total[..n], &own[..n]);
        for i in 0..n {
            let weight = total[i] + own[i];
            let mean = sums[i] / weight;
            sums[i] = if weight > T::ZERO { mean } else { T::ZERO };
        }
    }
}
