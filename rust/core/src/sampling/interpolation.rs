//! Streams that were interpolated: frames on geodesics between measurements that all joints have in common.
//!
//! The increments `w_t = 2 log(q_t⁻¹ q_{t+1})` are constant but at the knots, where the bend `a_t = |w_{t+1} − w_t|` is large in all joints
//! at once. A knot between the frames `t + 1` and `t + 2` bends the path at both; it lies at `t + 1 + f` with
//! `f = Σ a_{t+1} / (Σ a_t + Σ a_{t+1})`.

use super::{difference, increments, length, middle, quantile};
use crate::parallel::{self, Interrupt};
use crate::{ClipView, Error, Real};

/// Frames, from the start, on which it is decided whether a stream was interpolated.
const PROBE: usize = 4096;

/// Frames before and after over which the speed and the largest bend of a joint are taken.
const RADIUS: usize = 12;

/// Radians per frame: a joint that is slower says nothing about bends.
const SLOWEST: f64 = 0.02 * std::f64::consts::PI / 180.0;

/// Radians per frame: bends below are rounding.
const LEAST_BEND: f64 = 1e-5;

/// Quantile of the bends of a joint that stands for its knots.
const HIGH: f64 = 0.9;

/// Share of that quantile from which a joint bends.
const STEP: f64 = 0.15;

/// Share of the joints that bend: above `KNOT` the frame is a knot, below `INSIDE` it lies between knots.
const KNOT: f64 = 0.4;
const INSIDE: f64 = 0.2;

/// Joints that must be fast enough for a frame to be judged.
const FEWEST_JOINTS: usize = 3;

/// Share of the judged frames that must be knots or inside, and of the knots that must be at most two frames long.
const CLEAR: f64 = 0.8;

/// Share of the judged frames that may be knots.
const MOST_KNOTS: f64 = 0.65;

/// Median bend inside, over the median bend at knots, that is straight.
const STRAIGHT: f64 = 0.12;

/// Knots that there must be more of.
const FEWEST_KNOTS: usize = 10;

/// Estimated nanoseconds per frame and joint.
const NANOSECONDS: usize = 150;

/// A joint along time: its bends, which of them count, and which of those are large.
struct Bends {
    sizes: Vec<f64>,
    counted: Vec<bool>,
    large: Vec<bool>,
}

/// The times of the measurements between which a stream was interpolated, from 0 to the last frame.
pub(super) fn knot_times<T: Real>(
    q: ClipView<'_, T>,
    interrupt: &Interrupt,
) -> Result<Option<Vec<f64>>, Error> {
    if !interpolated(q.slice(0, q.frames().min(PROBE)), interrupt)? {
        return Ok(None);
    }
    let joints = bends(q, interrupt)?;
    let (_, knots) = judged(&joints);
    let weight = |t: usize| -> f64 {
        joints.iter().map(|joint| if joint.counted[t] { joint.sizes[t] } else { 0.0 }).sum()
    };
    let mut times = vec![0.0];
    for (start, end) in runs(&knots) {
        if end - start == 2 {
            let (first, second) = (weight(start), weight(start + 1));
            times.push((start + 1) as f64 + second / (first + second));
        } else {
            times.extend((start..end).map(|t| (t + 1) as f64));
        }
    }
    times.push((q.frames() - 1) as f64);
    times.dedup();
    Ok(Some(times))
}

/// Whether the bends of a stream are those of interpolation.
fn interpolated<T: Real>(q: ClipView<'_, T>, interrupt: &Interrupt) -> Result<bool, Error> {
    if q.frames() < 2 * RADIUS {
        return Ok(false);
    }
    let joints = bends(q, interrupt)?;
    let (inside, knots) = judged(&joints);
    let count = |frames: &[bool]| frames.iter().filter(|&&is| is).count() as f64;
    let sure = (0..knots.len()).filter(|&t| counted(&joints, t) >= FEWEST_JOINTS).count() as f64;
    let clusters = runs(&knots);
    let short = clusters.iter().filter(|(start, end)| end - start <= 2).count() as f64;
    if clusters.len() <= FEWEST_KNOTS || count(&inside) == 0.0 {
        return Ok(false);
    }
    let typical = |frames: &[bool]| {
        let mut values: Vec<f64> = joints
            .iter()
            .flat_map(|joint| {
                (0..frames.len()).filter(|&t| frames[t] && joint.counted[t]).map(|t| joint.sizes[t])
            })
            .collect();
        middle(&mut values)
    };
    Ok(count(&inside) + count(&knots) > CLEAR * sure
        && count(&knots) < MOST_KNOTS * sure
        && short > CLEAR * clusters.len() as f64
        && typical(&inside) < STRAIGHT * typical(&knots))
}

fn bends<T: Real>(q: ClipView<'_, T>, interrupt: &Interrupt) -> Result<Vec<Bends>, Error> {
    let joints: Vec<usize> = (0..q.joints()).collect();
    parallel::map(joints, q.frames() * q.joints() * NANOSECONDS, |_, joint| {
        interrupt.check()?;
        Ok(bends_of(&increments(q, joint, 1)))
    })
}

fn bends_of(steps: &[[f64; 3]]) -> Bends {
    let sizes: Vec<f64> = steps.windows(2).map(|pair| length(difference(pair[1], pair[0]))).collect();
    let speeds: Vec<f64> = steps.iter().map(|&step| length(step)).collect();
    let relative: Vec<Option<f64>> = (0..sizes.len())
        .map(|t| {
            let (speed, largest) = (window_mean(&speeds, t), window_largest(&sizes, t));
            let counts = sizes[t].is_finite() && speed > SLOWEST && largest > LEAST_BEND;
            counts.then(|| sizes[t] / speed)
        })
        .collect();
    let mut values: Vec<f64> = relative.iter().flatten().copied().collect();
    let least = STEP * quantile(&mut values, HIGH);
    Bends {
        sizes,
        counted: relative.iter().map(Option::is_some).collect(),
        large: relative.iter().map(|value| value.is_some_and(|value| value > least)).collect(),
    }
}

/// Joints that count at a frame.
fn counted(joints: &[Bends], t: usize) -> usize {
    joints.iter().filter(|joint| joint.counted[t]).count()
}

/// The frames inside, and those at knots.
fn judged(joints: &[Bends]) -> (Vec<bool>, Vec<bool>) {
    let frames = joints.first().map_or(0, |joint| joint.sizes.len());
    (0..frames)
        .map(|t| {
            let total = counted(joints, t);
            let many = joints.iter().filter(|joint| joint.large[t]).count() as f64;
            let sure = total >= FEWEST_JOINTS;
            (sure && many < INSIDE * total as f64, sure && many > KNOT * total as f64)
        })
        .unzip()
}

/// First index, and index after the last, of every run of true values.
fn runs(mask: &[bool]) -> Vec<(usize, usize)> {
    let mut found = Vec::new();
    let mut start = None;
    for (t, &is) in mask.iter().chain([&false]).enumerate() {
        match (is, start) {
            (true, None) => start = Some(t),
            (false, Some(first)) => {
                found.push((first, t));
                start = None;
            }
            _ => {}
        }
    }
    found
}

/// Mean of the finite values within [`RADIUS`] frames, 0 where there is none.
fn window_mean(values: &[f64], t: usize) -> f64 {
    let (mut total, mut count) = (0.0, 0_usize);
    for &value in window(values, t) {
        if value.is_finite() {
            total += value;
            count += 1;
        }
    }
    if count > 0 { total / count as f64 } else { 0.0 }
}

/// Largest of the finite values within [`RADIUS`] frames, 0 where there is none.
fn window_largest(values: &[f64], t: usize) -> f64 {
    window(values, t).iter().copied().filter(|value| value.is_finite()).fold(0.0, f64::max)
}

fn window(values: &[f64], t: usize) -> &[f64] {
    &values[t.saturating_sub(RADIUS)..values.len().min(t + RADIUS + 1)]
}
