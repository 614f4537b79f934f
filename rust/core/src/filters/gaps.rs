//! Gaps: runs of missing samples.

use crate::error::check_length;
use crate::rotations::continuity::make_continuous;
use crate::rotations::quaternion::{
    between, dot, exp_one, is_missing, log_one, log_short, negative, of_row, product, unit,
};
use crate::rotations::resample::between_neighbours;
use crate::{ClipMut, ClipView, Error, Real, parallel};

/// Samples per task.
const TILE: usize = 32 * 1024;

/// Interpolation through a gap.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// The shorter geodesic, at constant angular velocity.
    Slerp,
    /// Shoemake's spherical cubic, which matches the angular velocities at its ends.
    Squad,
}

/// A run of missing samples of one joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Run {
    joint: usize,
    start: usize,
    end: usize,
}

/// Copies `q` to `out`, and returns the indices of the missing samples, as `frame · joints + joint`.
fn copy<T: Real>(q: &[T], out: &mut [T]) -> Result<Vec<usize>, Error> {
    let tiles: Vec<(&[T], &mut [T])> = q.chunks(TILE * 4).zip(out.chunks_mut(TILE * 4)).collect();
    let missing = parallel::map(tiles, q.len() / 4, |tile, (q, out)| {
        out.copy_from_slice(q);
        let rows = q.chunks_exact(4).enumerate();
        let missing = rows.filter(|(_, row)| is_missing(of_row(row)));
        Ok(missing.map(|(i, _)| tile * TILE + i).collect::<Vec<usize>>())
    })?;
    Ok(missing.concat())
}

/// The runs of missing samples, joint by joint.
fn runs(missing: &[usize], joints: usize) -> Vec<Run> {
    let mut places: Vec<(usize, usize)> = missing.iter().map(|&at| (at % joints, at / joints)).collect();
    places.sort_unstable();
    let mut runs: Vec<Run> = Vec::new();
    for (joint, frame) in places {
        match runs.last_mut() {
            Some(run) if run.joint == joint && run.end == frame => run.end += 1,
            _ => runs.push(Run { joint, start: frame, end: frame + 1 }),
        }
    }
    runs
}

/// A valid sample and its frame.
#[derive(Debug, Clone, Copy)]
struct Key {
    frame: usize,
    q: [f64; 4],
}

/// Half the rotation vector per frame from one key to the next.
fn slope(from: Key, to: Key) -> [f64; 3] {
    let frames = to.frame.abs_diff(from.frame) as f64;
    log_short(between(from.q, to.q)).map(|x| x / frames)
}

/// Half the rotation vector per frame at `key`: the slope of the parabola through `before`, `key` and `after`, or
/// that of the geodesic if one of them does not exist.
fn velocity(before: Option<Key>, key: Key, after: Option<Key>) -> [f64; 3] {
    match (before, after) {
        (Some(before), Some(after)) => {
            let (h, k) = ((key.frame - before.frame) as f64, (after.frame - key.frame) as f64);
            let (v, w) = (slope(before, key), slope(key, after));
            std::array::from_fn(|c| (k * v[c] + h * w[c]) / (h + k))
        }
        (Some(before), None) => slope(before, key),
        (None, Some(after)) => slope(key, after),
        (None, None) => [0.0; 3],
    }
}

/// The rotation at the fraction `part` from `x` to `y`, with the signs as given.
fn along(x: [f64; 4], y: [f64; 4], part: f64) -> [f64; 4] {
    product(x, exp_one(log_one(between(x, y)).map(|v| v * part)))
}

/// Shoemake's spherical cubic between two keys, with the velocities at its ends.
struct Squad {
    a: [f64; 4],
    b: [f64; 4],
    after_a: [f64; 4],
    before_b: [f64; 4],
}

impl Squad {
    /// The curve through the middle two of four keys.
    fn new(before: Option<Key>, a: Key, b: Key, after: Option<Key>) -> Self {
        let frames = (b.frame - a.frame) as f64;
        let b = if dot(a.q, b.q) < 0.0 { Key { q: negative(b.q), ..b } } else { b };
        let chord = log_short(between(a.q, b.q));
        let (v, w) = (velocity(before, a, Some(b)), velocity(Some(a), b, after));
        let towards = |q, by: [f64; 3]| product(q, exp_one(by.map(|x| x / 2.0)));
        Self {
            a: a.q,
            b: b.q,
            after_a: towards(a.q, std::array::from_fn(|c| frames * v[c] - chord[c])),
            before_b: towards(b.q, std::array::from_fn(|c| chord[c] - frames * w[c])),
        }
    }

    fn at(&self, part: f64) -> [f64; 4] {
        let outer = along(self.a, self.b, part);
        let inner = along(self.after_a, self.before_b, part);
        along(outer, inner, 2.0 * part * (1.0 - part))
    }
}

/// The two nearest valid samples before and after a run: the arguments of [`Squad::new`].
///
/// `runs` are those of all joints, in order.
fn keys<T: Real>(
    q: ClipView<'_, T>,
    runs: &[Run],
    index: usize,
) -> Option<(Option<Key>, Key, Key, Option<Key>)> {
    let run = runs[index];
    let key = |frame: usize| Key { frame, q: unit(q.at(frame, run.joint).map(T::to_f64)) };
    let a = run.start.checked_sub(1)?;
    let b = Some(run.end).filter(|&frame| frame < q.frames())?;
    let earlier = index.checked_sub(1).map(|i| runs[i]).filter(|r| r.joint == run.joint && r.end == a);
    let later = runs.get(index + 1).copied().filter(|r| r.joint == run.joint && r.start == b + 1);
    let before = earlier.map_or(a, |r| r.start).checked_sub(1);
    let after = Some(later.map_or(b + 1, |r| r.end)).filter(|&frame| frame < q.frames());
    Some((before.map(key), key(a), key(b), after.map(key)))
}

/// Fills the runs of missing samples of each joint.
///
/// A run between two valid samples is interpolated with `method`; a run at an end of the clip repeats the nearest
/// valid sample. Runs of more than `max_gap` frames (`None`: no limit) and joints without any valid sample become
/// NaN. `filled` marks the filled samples, `(frames, joints)`. The result is continuous in sign from the first valid
/// sample.
///
/// # Errors
/// [`Error::Length`] if the lengths of slices do not agree.
pub fn fill_gaps<T: Real>(
    q: ClipView<'_, T>,
    max_gap: Option<usize>,
    method: Method,
    out: ClipMut<'_, T>,
    filled: &mut [bool],
) -> Result<(), Error> {
    let (frames, joints) = (q.frames(), q.joints());
    let out = out.into_data();
    check_length("out", q.data().len(), out.len())?;
    check_length("filled", frames * joints, filled.len())?;
    filled.fill(false);
    if out.is_empty() {
        return Ok(());
    }
    let missing = copy(q.data(), out)?;
    let runs = runs(&missing, joints);
    for (index, &run) in runs.iter().enumerate() {
        let before = run.start.checked_sub(1).map(|frame| q.at(frame, run.joint));
        let after = (run.end < frames).then(|| q.at(run.end, run.joint));
        let short = max_gap.is_none_or(|most| run.end - run.start <= most);
        let ends = before.or(after).zip(after.or(before)).filter(|_| short);
        let curve = if method == Method::Squad && short { keys(q, &runs, index) } else { None };
        let curve = curve.map(|(before, a, b, after)| Squad::new(before, a, b, after));
        let intervals = (run.end - run.start + 1) as f64;
        for frame in run.start..run.end {
            let steps = (frame + 1 - run.start) as f64;
            let value = ends.map_or([T::nan(); 4], |(a, b)| {
                if let Some(curve) = &curve {
                    return curve.at(steps / intervals).map(T::from_f64);
                }
                let part = T::from_f64(steps) / T::from_f64(intervals);
                // Between equal ends, as at the ends of a clip, the result is that sample.
                between_neighbours(a, b, if before.is_none() || after.is_none() { T::ZERO } else { part })
            });
            let at = frame * joints + run.joint;
            out[at * 4..at * 4 + 4].copy_from_slice(&value);
            filled[at] = ends.is_some();
        }
    }
    make_continuous(out, joints)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_end_with_their_joint() {
        let found = runs(&[0, 1, 3, 4, 9], 2);
        let run = |joint, start, end| Run { joint, start, end };
        assert_eq!(found, [run(0, 0, 1), run(0, 2, 3), run(1, 0, 2), run(1, 4, 5)]);
    }
}
