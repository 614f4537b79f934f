//! Target positions of a foot during a contact.

use super::contacts::FEWEST;
use super::paths::low_passed;
use super::{Point, speeds};
use crate::parallel::Interrupt;
use crate::{Error, Real};
use std::ops::Range;

/// Standard deviations, in seconds, of the low-passes that are tried, the longest first; the last resort is the path
/// itself.
const SIGMAS: [f64; 11] = [0.4, 0.28, 0.2, 0.14, 0.1, 0.07, 0.05, 0.035, 0.025, 0.0175, 0.0125];

/// Limits of the standard deviation in seconds and in frames: one of them must hold. Low frame rates need longer
/// averages.
const ALWAYS: f64 = 0.1;
const MOST_FRAMES: f64 = 12.5;

/// Largest root-mean-square change per coordinate by a low-pass within a contact, in units of the noise.
const FIT: f64 = 0.35;

/// Range within a contact above which a locked foot makes a step: centimetres, and per centimetre of noise.
const RANGE: f64 = 3.0;
const RANGE_NOISE: f64 = 0.5;

/// Length of the gap at such a step, seconds.
const STEP: f64 = 0.04;

/// Shortest time for which a foot is locked, seconds.
const SHORTEST_HOLD: f64 = 0.1;

/// The smoothest version of a path within a contact that differs from it by no more than a fraction of the noise.
pub(super) fn smoothed(
    y: &[Point],
    noise: f64,
    fps: f64,
    interrupt: &Interrupt,
) -> Result<Vec<Point>, Error> {
    let limit = FIT * noise * (FIT * noise);
    for sigma in SIGMAS.into_iter().filter(|sigma| *sigma <= ALWAYS || sigma * fps <= MOST_FRAMES) {
        let result = low_passed(y, sigma * fps, interrupt)?;
        let squares: f64 =
            result.as_flattened().iter().zip(y.as_flattened()).map(|(a, b)| (a - b) * (a - b)).sum();
        if squares / (3 * y.len()) as f64 <= limit {
            return Ok(result);
        }
    }
    Ok(y.to_vec())
}

/// Locks a contact: the horizontal target is the median of the path, in several pieces if the foot moves too far.
pub(super) fn hold(
    y: &[Point],
    target: &mut [Point],
    held: &mut [bool],
    contact: Range<usize>,
    noise: f64,
    up: usize,
    fps: f64,
) {
    let sides = [(up + 1) % 3, (up + 2) % 3];
    let shortest = FEWEST.max((SHORTEST_HOLD * fps).ceil().to_count());
    let gap = (STEP * fps).round_ties_even().to_count().max(1);
    let speed = speeds(y);
    let mut waiting = vec![contact];
    while let Some(Range { start, end }) = waiting.pop() {
        if end - start < shortest {
            held[start..end].fill(false);
            continue;
        }
        let extent = |side: usize| {
            let (low, high) =
                y[start..end].iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), point| {
                    (f64::min(low, point[side]), f64::max(high, point[side]))
                });
            high - low
        };
        let [a, b] = sides.map(extent);
        if (a * a + b * b).sqrt() <= RANGE + RANGE_NOISE * noise {
            for side in sides {
                let middle = median(y[start..end].iter().map(|point| point[side]).collect());
                for point in &mut target[start..end] {
                    point[side] = middle;
                }
            }
            continue;
        }
        let peak = (start..end).fold(start, |best, t| if speed[t] > speed[best] { t } else { best });
        let first = start.max(peak.saturating_sub(gap / 2));
        let last = end.min(peak + (gap - gap / 2));
        held[first..last].fill(false);
        waiting.push(start..first);
        waiting.push(last..end);
    }
}

/// The median of at least one value.
fn median(mut values: Vec<f64>) -> f64 {
    let middle = values.len() / 2;
    let even = values.len().is_multiple_of(2);
    let (below, &mut high, _) = values.select_nth_unstable_by(middle, f64::total_cmp);
    if even { below.iter().copied().fold(f64::NEG_INFINITY, f64::max).midpoint(high) } else { high }
}
