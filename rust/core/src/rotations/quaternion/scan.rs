//! Checks of a clip: missing samples, and the largest deviation from unit length.

use super::one::{dot, is_missing, of_row};
use crate::simd::multiversion;
use crate::{ClipView, Error, Real, parallel};

/// Result of [`scan`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scan {
    /// Number of missing samples.
    pub missing: usize,
    /// The largest `||q| − 1|` over the others, 0 if there are none.
    pub worst: f64,
    /// Index of that sample, as `frame · joints + joint`: the first one, up to the rounding of the type.
    pub index: usize,
}

/// Samples per task.
const TILE: usize = 64 * 1024;

/// Samples between two checks for unusual values: few, so that one of them costs little.
const BLOCK: usize = 1024;

/// Number of accumulators: one vector of float32 at the widest level.
const LANES: usize = 16;

/// Extremes of a range of samples.
#[derive(Debug, Clone, Copy)]
struct Extremes<T> {
    missing: usize,
    /// The largest squared length, negative if every sample is missing.
    high: T,
    /// The smallest squared length.
    low: T,
}

impl<T: Real> Extremes<T> {
    #[inline(always)]
    fn none() -> Self {
        Self { missing: 0, high: -T::ONE, low: T::ONE / T::ZERO }
    }

    #[inline(always)]
    fn and(self, other: Self) -> Self {
        Self {
            missing: self.missing + other.missing,
            high: other.high.max(self.high),
            low: other.low.min(self.low),
        }
    }
}

/// Squared lengths of 0 or infinity may be missing samples or extreme ones: this checks each component.
#[inline(always)]
fn carefully<T: Real>(rows: &[T]) -> Extremes<T> {
    let mut found = Extremes::none();
    for row in rows.chunks_exact(4) {
        let q = of_row(row);
        let square = dot(q, q);
        if is_missing(q) {
            found.missing += 1;
        } else {
            found.high = square.max(found.high);
            found.low = square.min(found.low);
        }
    }
    found
}

multiversion! {
    fn extremes<T: Real>(rows: &[T]) -> Extremes<T> {
        let mut found = Extremes::none();
        for block in rows.chunks(BLOCK * 4) {
            let mut high = [-T::ONE; LANES];
            let mut low = [T::ONE / T::ZERO; LANES];
            let mut missing = [T::ZERO; LANES];
            let groups = block.chunks_exact(LANES * 4);
            let rest = carefully(groups.remainder());
            for group in groups {
                for lane in 0..LANES {
                    let q = of_row(&group[lane * 4..lane * 4 + 4]);
                    let square = dot(q, q);
                    high[lane] = square.max(high[lane]);
                    low[lane] = square.min(low[lane]);
                    missing[lane] += if square.is_nan() { T::ONE } else { T::ZERO };
                }
            }
            let mut regular = Extremes::none();
            let mut count = T::ZERO;
            for lane in 0..LANES {
                regular.high = high[lane].max(regular.high);
                regular.low = low[lane].min(regular.low);
                count += missing[lane];
            }
            regular.missing = count.to_count();
            let doubtful = (regular.low == T::ZERO) | !regular.high.is_finite();
            found = found.and(if doubtful { carefully(block) } else { regular.and(rest) });
        }
        found
    }
}

/// The first sample of squared length `square`, and its distance from unit length.
fn locate<T: Real>(
    q: &[T],
    tiles: &[Extremes<T>],
    square: T,
    of: impl Fn(&Extremes<T>) -> T,
) -> (f64, usize) {
    let tile = tiles.iter().position(|tile| of(tile) == square).unwrap_or(0);
    let rows = &q[tile * TILE * 4..];
    let first = rows.chunks_exact(4).map(of_row).position(|q| dot(q, q) == square && !is_missing(q));
    let index = tile * TILE + first.unwrap_or(0);
    (deviation(of_row(&q[index * 4..])), index)
}

fn deviation<T: Real>(q: [T; 4]) -> f64 {
    let q = q.map(T::to_f64);
    (dot(q, q).sqrt() - 1.0).abs()
}

/// The largest deviation if a squared length overflowed: computed in float64 for all samples.
#[cold]
fn worst_of_absurd<T: Real>(q: &[T]) -> (f64, usize) {
    let samples = q.chunks_exact(4).map(of_row).enumerate().filter(|&(_, q)| !is_missing(q));
    samples.fold((0.0, 0), |worst, (index, q)| {
        let this = deviation(q);
        if this > worst.0 { (this, index) } else { worst }
    })
}

/// Counts the missing samples, and finds the sample that is farthest from unit length.
///
/// One pass at about the speed of memory; the index of the worst sample is located afterwards.
///
/// # Errors
/// None but those of the thread pool's callers.
pub fn scan<T: Real>(q: ClipView<'_, T>) -> Result<Scan, Error> {
    let q = q.data();
    let tiles: Vec<&[T]> = q.chunks(TILE * 4).collect();
    let tiles = parallel::map(tiles, q.len() / 4, |_, tile| Ok(extremes(tile)))?;
    let all = tiles.iter().fold(Extremes::none(), |all, &tile| all.and(tile));
    if all.high < T::ZERO {
        return Ok(Scan { missing: all.missing, worst: 0.0, index: 0 });
    }
    let (worst, index) = if all.high.is_finite() {
        let long = locate(q, &tiles, all.high, |tile| tile.high);
        let short = locate(q, &tiles, all.low, |tile| tile.low);
        let short_is_worse = short.0 > long.0 || (short.0 >= long.0 && short.1 < long.1);
        if short_is_worse { short } else { long }
    } else {
        worst_of_absurd(q)
    };
    Ok(Scan { missing: all.missing, worst, index })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn clip<T: Real>(n: usize) -> Vec<T> {
        (0..n).flat_map(|i| [0.0, if i % 2 == 0 { 0.6 } else { -0.6 }, 0.0, 0.8].map(T::from_f64)).collect()
    }

    fn scanned<T: Real>(q: &[T]) -> Scan {
        scan(ClipView::new(q, q.len() / 4, 1).expect("the length fits")).expect("nothing can fail")
    }

    #[test]
    fn every_odd_sample_is_counted_wherever_it_stands() {
        for n in [1, 15, 16, 17, 1023, 1024, 1040, 2 * TILE + 5] {
            for at in [0, n / 2, n - 1] {
                for odd in [[f32::NAN, 0.0, 0.0, 1.0], [0.0; 4], [0.0, f32::INFINITY, 0.0, 0.0]] {
                    let mut q = clip::<f32>(n);
                    q[at * 4..at * 4 + 4].copy_from_slice(&odd);
                    let found = scanned(&q);
                    assert_eq!(found.missing, 1, "{n} {at} {odd:?}");
                    assert!(found.worst < 1e-6, "{n} {at} {odd:?}: {}", found.worst);
                }
            }
        }
    }

    #[test]
    fn the_first_of_the_worst_is_found() {
        let n = TILE + 100;
        for (length, worst) in [(1.5, 0.5), (0.25, 0.75)] {
            let mut q = clip::<f64>(n);
            for at in [TILE + 3, TILE + 50] {
                q[at * 4..at * 4 + 4].copy_from_slice(&[0.0, 0.0, length, 0.0]);
            }
            assert_eq!(scanned(&q), Scan { missing: 0, worst, index: TILE + 3 });
        }
    }

    #[test]
    fn squares_that_overflow_or_vanish_belong_to_samples() {
        let mut q = clip::<f32>(40);
        q[8] = 1e-30;
        q[9..12].fill(0.0);
        let found = scanned(&q);
        assert_eq!((found.missing, found.worst, found.index), (0, 1.0, 2));
        q[80] = 1e25;
        q[120] = 1e26;
        let found = scanned(&q);
        assert_eq!((found.missing, found.index), (0, 30));
    }
}
