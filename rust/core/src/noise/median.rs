//! The median of absolute values, exact, in about one pass.
//!
//! A regular sample of the values brackets the median closely; passes that vectorise count what lies below the bracket
//! and keep what lies inside, and the median is selected from those few. Where the sample misleads, all are kept.

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
    /// How many absolute values lie below `bound`.
    fn below<T: Real>(values: &[T], bound: T) -> usize {
        count(values, |x| x.abs() < bound)
    }
}

multiversion! {
    /// Keeps the absolute values from `low` to `high`, which are few: most groups hold none.
    fn keep<T: Real>(values: &[T], low: T, high: T, kept: &mut Vec<T>) {
        kept.clear();
        let inside = |x: T| (x.abs() >= low) & (x.abs() <= high);
        let groups = values.chunks_exact(LANES);
        let rest = groups.remainder();
        for group in groups {
            let mut hit = false;
            for &x in group {
                hit |= inside(x);
            }
            if hit {
                // Every value is written, and the place moves on behind those that stay: no branch to foresee.
                let mut few = [T::ZERO; LANES];
                let mut next = 0;
                for &x in group {
                    few[next % LANES] = x.abs();
                    next += usize::from(inside(x));
                }
                kept.extend_from_slice(&few[..next]);
            }
        }
        kept.extend(rest.iter().filter(|&&x| inside(x)).map(|x| x.abs()));
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

/// A regular sample of the absolute values: what lies about its middle, sorted, and where in it the middle is.
fn about_the_middle<'a, T: Real>(values: &[T], sample: &'a mut Vec<T>) -> Option<(&'a [T], usize)> {
    sample.clear();
    let step = values.len().div_ceil(SAMPLE);
    sample.extend(values.iter().step_by(step).filter(|x| !x.is_nan()).map(|x| x.abs()));
    let half = sample.len() / 2;
    let spread = sample.len().isqrt() * 2 + 1;
    let lowest = half.checked_sub(spread)?;
    if half + spread >= sample.len() {
        return None;
    }
    sample.select_nth_unstable_by(half + spread, order);
    sample[..half + spread].select_nth_unstable_by(lowest, order);
    let inner = &mut sample[lowest..=half + spread];
    inner.sort_unstable_by(order);
    Some((inner, spread))
}

/// Bounds between which the median of the `n` absolute values is expected.
///
/// The rank of the sample's median among all values tells by how much it misses theirs; near it, the sample then tells
/// the rest with a much smaller error.
fn expected<T: Real>(values: &[T], n: usize, sample: &mut Vec<T>) -> Option<(T, T)> {
    let (inner, middle) = about_the_middle(values, sample)?;
    let under = below(values, inner[middle]);
    let samples = SAMPLE.min(n);
    let miss = (n / 2).abs_diff(under) * samples / n;
    let margin = miss.isqrt() * 3 + 3;
    let centre = if under <= n / 2 { middle + miss } else { middle.checked_sub(miss)? };
    let low = *inner.get(centre.checked_sub(margin)?)?;
    inner.get(centre + margin).map(|&high| (low, high))
}

/// The median of the absolute values of those that are numbers, as NumPy's: of an even count, the mean of the two in
/// the middle. `None` for fewer than `fewest`; `complete` says that all are numbers.
pub(super) fn median_of_absolute<T: Real>(
    values: &[T],
    complete: bool,
    fewest: usize,
    buffer: &mut Vec<T>,
) -> Option<f64> {
    let n = if complete { values.len() } else { numbers(values) };
    if n < fewest.max(1) {
        return None;
    }
    let close = if n > FEW { expected(values, n, buffer) } else { None };
    let found = close.and_then(|(low, high)| {
        keep(values, low, high, buffer);
        middle(buffer, below(values, low), n)
    });
    let (low, high) = found.or_else(|| {
        buffer.clear();
        buffer.extend(values.iter().filter(|x| !x.is_nan()).map(|x| x.abs()));
        middle(buffer, 0, n)
    })?;
    Some(f64::midpoint(low.to_f64(), high.to_f64()))
}

/// Whether all values are numbers.
pub(super) fn all_numbers<T: Real>(values: &[T]) -> bool {
    numbers(values) == values.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(values: &[f64]) {
        let mut sorted: Vec<f64> = values.iter().filter(|x| !x.is_nan()).map(|x| x.abs()).collect();
        sorted.sort_by(order);
        let n = sorted.len();
        let expected = (n > 0).then(|| f64::midpoint(sorted[(n - 1) / 2], sorted[n / 2]));
        let complete = all_numbers(values);
        assert_eq!(median_of_absolute(values, complete, 1, &mut Vec::new()), expected, "{n} values");
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
        assert_eq!(median_of_absolute(&[1.0_f32, f32::NAN], false, 2, &mut Vec::new()), None);
    }
}
