//! The median of absolute values, exact, in about one pass.
//!
//! A regular sample of the values brackets the median closely; one pass counts what lies below the bracket and keeps
//! what lies inside, and the median is selected from those few. Where the sample misleads, all values are kept.

use crate::Real;
use crate::simd::multiversion;
use std::cmp::Ordering;

/// About how many values bracket the median.
const SAMPLE: usize = 2048;

/// Up to so many values are selected from directly.
const FEW: usize = 4 * SAMPLE;

/// Accumulators side by side: one vector of float32 at the widest level.
const LANES: usize = 16;

/// Counts per lane stay exact in float32 over so many values.
const BLOCK: usize = 1 << 20;

fn order<T: Real>(a: &T, b: &T) -> Ordering {
    a.partial_cmp(b).unwrap_or(Ordering::Equal)
}

/// The sum over `values` of `test`, 0 or 1 each.
#[inline(always)]
fn count<T: Real>(values: &[T], test: impl Fn(T) -> bool) -> usize {
    let mut total = 0;
    for block in values.chunks(BLOCK) {
        let mut lanes = [T::ZERO; LANES];
        let groups = block.chunks_exact(LANES);
        for &x in groups.remainder() {
            total += usize::from(test(x));
        }
        for group in groups {
            for lane in 0..LANES {
                lanes[lane] += if test(group[lane]) { T::ONE } else { T::ZERO };
            }
        }
        total += lanes.iter().map(|lane| lane.to_count()).sum::<usize>();
    }
    total
}

multiversion! {
    /// How many values are numbers.
    fn numbers<T: Real>(values: &[T]) -> usize {
        count(values, |x| !x.is_nan())
    }
}

multiversion! {
    /// How many absolute values lie below `low`; those from `low` to `high` are kept.
    fn bracket<T: Real>(values: &[T], low: T, high: T, kept: &mut Vec<T>) -> usize {
        kept.resize(values.len() + 1, T::ZERO);
        let (lowest, width) = (low.rank(), high.rank() - low.rank());
        let mut next = 0;
        for &x in values {
            kept[next] = x.abs();
            // One comparison of whole numbers, where two of floats would go through mask registers.
            next += usize::from(x.rank().wrapping_sub(lowest) <= width);
        }
        kept.truncate(next);
        count(values, |x| x.abs() < low)
    }
}

/// The values at the ranks `(n − 1) / 2` and `n / 2` of `n` values, if `kept` holds both and `below` lie under it.
fn middle<T: Real>(kept: &mut [T], below: usize, n: usize) -> Option<(T, T)> {
    let upper = (n / 2).checked_sub(below)?;
    if upper >= kept.len() || (n.is_multiple_of(2) && upper == 0) {
        return None;
    }
    let (under, &mut high, _) = kept.select_nth_unstable_by(upper, order);
    let low = if n.is_multiple_of(2) { under.iter().copied().reduce(Real::max)? } else { high };
    Some((low, high))
}

/// Bounds between which the median of the absolute values is expected.
fn expected<T: Real>(values: &[T], sample: &mut Vec<T>) -> Option<(T, T)> {
    sample.clear();
    let step = values.len().div_ceil(SAMPLE);
    sample.extend(values.iter().step_by(step).filter(|x| !x.is_nan()).map(|x| x.abs()));
    let half = sample.len() / 2;
    let spread = sample.len().isqrt() * 3 / 2 + 1;
    let (lowest, highest) = (half.checked_sub(spread)?, half + spread);
    if highest >= sample.len() {
        return None;
    }
    let (under, &mut high, _) = sample.select_nth_unstable_by(highest, order);
    let (_, &mut low, _) = under.select_nth_unstable_by(lowest, order);
    Some((low, high))
}

/// The median of the absolute values of those that are numbers, as NumPy's: of an even count, the mean of the two in
/// the middle. `None` for fewer than `fewest`.
pub(super) fn median_of_absolute<T: Real>(values: &[T], fewest: usize, buffer: &mut Vec<T>) -> Option<f64> {
    let n = numbers(values);
    if n < fewest.max(1) {
        return None;
    }
    let close = if n > FEW { expected(values, buffer) } else { None };
    let found = close.and_then(|(low, high)| {
        let below = bracket(values, low, high, buffer);
        middle(buffer, below, n)
    });
    let (low, high) = found.or_else(|| {
        buffer.clear();
        buffer.extend(values.iter().filter(|x| !x.is_nan()).map(|x| x.abs()));
        middle(buffer, 0, n)
    })?;
    Some(f64::midpoint(low.to_f64(), high.to_f64()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(values: &[f64]) {
        let mut sorted: Vec<f64> = values.iter().filter(|x| !x.is_nan()).map(|x| x.abs()).collect();
        sorted.sort_by(order);
        let n = sorted.len();
        let expected = (n > 0).then(|| f64::midpoint(sorted[(n - 1) / 2], sorted[n / 2]));
        assert_eq!(median_of_absolute(values, 1, &mut Vec::new()), expected, "{n} values");
    }

    fn random(n: usize) -> Vec<f64> {
        let mut state = 7_u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64
        };
        (0..n).map(|_| next().ln() - next().ln()).collect()
    }

    #[test]
    fn medians_are_exact() {
        for n in [0, 1, 2, 3, 16, 17, FEW, FEW + 1, 100_001, 100_002] {
            let values = random(n);
            check(&values);
            let gaps: Vec<f64> =
                values.iter().enumerate().map(|(i, &x)| if i % 3 == 1 { f64::NAN } else { x }).collect();
            check(&gaps);
            check(&vec![0.5; n]);
        }
    }

    #[test]
    fn a_sample_that_misleads_does_no_harm() {
        // Every 50th value, those that the sample takes, differs from all others.
        let n = 100_000;
        for alike in [0.0, 1e6] {
            let values: Vec<f64> =
                random(n).into_iter().enumerate().map(|(i, x)| if i % 49 == 0 { alike } else { x }).collect();
            check(&values);
        }
    }

    #[test]
    fn too_few_have_no_median() {
        assert_eq!(median_of_absolute(&[1.0_f32, f32::NAN], 2, &mut Vec::new()), None);
    }
}
