//! Gaps: runs of missing samples.

use crate::error::check_length;
use crate::rotations::continuity::make_continuous;
use crate::rotations::quaternion::{is_missing, of_row};
use crate::rotations::resample::between_neighbours;
use crate::{ClipMut, ClipView, Error, Real, parallel};

/// Samples per task.
const TILE: usize = 32 * 1024;

/// A run of missing samples of one joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Run {
    joint: usize,
    start: usize,
    end: usize,
}

/// Copies `q` to `out`, and returns the places of the missing samples, as `frame · joints + joint`.
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

/// Fills the runs of missing samples of each joint.
///
/// A run between two valid samples is filled along the shorter geodesic between them, at constant angular velocity; a
/// run at an end of the clip is held at the nearest valid sample. Runs of more than `max_gap` frames (`None`: no limit)
/// and joints without any valid sample become NaN. `filled` tells where samples were filled in, `(frames, joints)`. The
/// result is continuous in sign from the first valid sample.
///
/// # Errors
/// [`Error::Length`] if the slices do not fit.
pub fn fill_gaps<T: Real>(
    q: ClipView<'_, T>,
    max_gap: Option<usize>,
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
    for run in runs(&missing, joints) {
        let before = run.start.checked_sub(1).map(|frame| q.at(frame, run.joint));
        let after = (run.end < frames).then(|| q.at(run.end, run.joint));
        let short = max_gap.is_none_or(|most| run.end - run.start <= most);
        let ends = before.or(after).zip(after.or(before)).filter(|_| short);
        let intervals = T::from_f64((run.end - run.start + 1) as f64);
        for frame in run.start..run.end {
            let value = ends.map_or([T::nan(); 4], |(a, b)| {
                let part = T::from_f64((frame + 1 - run.start) as f64) / intervals;
                // Between equal ends, which hold a sample, every part is that sample.
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
