//! Interpolation of rotations in time.

use super::continuity::{continuous, make_continuous};
use super::quaternion::{geodesic, unit};
use crate::error::check_length;
use crate::simd::multiversion;
use crate::{ClipMut, ClipView, Error, Real, parallel};

/// Rows per chunk: their planes fit in the first-level cache.
const CHUNK: usize = 64;

/// Rows per task.
const TASK: usize = 8 * 1024;

/// A new time between two samples.
#[derive(Debug, Clone, Copy)]
struct Place {
    /// The frame before it.
    left: usize,
    /// The fraction of the interval to the next frame, 0 … 1.
    part: f64,
}

/// Locates `time` among `times`; the last interval includes its right end.
fn place(times: &[f64], time: f64) -> Place {
    if times.len() < 2 {
        return Place { left: 0, part: 0.0 };
    }
    let after = times.partition_point(|&t| t <= time);
    let left = after.saturating_sub(1).min(times.len() - 2);
    Place { left, part: (time - times[left]) / (times[left + 1] - times[left]) }
}

/// A rotation between `a` and `b`; at both ends exactly the normalised quaternion.
#[inline(always)]
pub(crate) fn between_neighbours<T: Real>(a: [T; 4], b: [T; 4], part: T) -> [T; 4] {
    let (a, b) = (unit(a), unit(b));
    let way = geodesic(a, b, part);
    let (at_a, at_b) = (part == T::ZERO, part == T::ONE);
    std::array::from_fn(|c| {
        let inside = if at_b { b[c] } else { way[c] };
        if at_a { a[c] } else { inside }
    })
}

multiversion! {
    /// Interpolates the rows of `out`, `(frames, joints)`, at `places`, one for each frame.
    fn interpolate<T: Real>(q: &[T], joints: usize, places: &[Place], out: &mut [T]) {
        let rows = places.len() * joints;
        for start in (0..rows).step_by(CHUNK) {
            let length = CHUNK.min(rows - start);
            let mut a = [[T::ONE; CHUNK]; 4];
            let mut b = [[T::ONE; CHUNK]; 4];
            let mut part = [T::ZERO; CHUNK];
            let (mut frame, mut joint) = (start / joints, start % joints);
            for i in 0..length {
                let Place { left, part: p } = places[frame];
                let here = (left * joints + joint) * 4;
                // A single frame has no right neighbour; its part is 0.
                let there = if here + joints * 4 < q.len() { here + joints * 4 } else { here };
                part[i] = T::from_f64(p);
                for c in 0..4 {
                    a[c][i] = q[here + c];
                    b[c][i] = q[there + c];
                }
                joint += 1;
                if joint == joints {
                    (frame, joint) = (frame + 1, 0);
                }
            }
            for i in 0..CHUNK {
                let value = between_neighbours(
                    std::array::from_fn(|c| a[c][i]),
                    std::array::from_fn(|c| b[c][i]),
                    part[i],
                );
                for c in 0..4 {
                    a[c][i] = value[c];
                }
            }
            for i in 0..length {
                for c in 0..4 {
                    out[(start + i) * 4 + c] = a[c][i];
                }
            }
        }
    }
}

/// Rotations at new times, each on the shorter geodesic between its two neighbours: `(new times, joints, 4)`.
///
/// `q(t) = q_i · exp(u log(q_i⁻¹ q_{i+1}))` with `u = (t − t_i) / (t_{i+1} − t_i)`. At the time of a sample the
/// result is that sample; next to a missing sample it is NaN. `times` increase strictly, and `new_times` are in their
/// range.
///
/// # Errors
/// [`Error::Length`] if the lengths of slices do not agree; [`Error::Parameter`] for new times without any sample.
pub fn slerp<T: Real>(
    q: ClipView<'_, T>,
    times: &[f64],
    new_times: &[f64],
    out: ClipMut<'_, T>,
) -> Result<(), Error> {
    let joints = q.joints();
    check_length("times", q.frames(), times.len())?;
    check_length("out", new_times.len() * joints * 4, out.frames() * out.joints() * 4)?;
    let out = out.into_data();
    if out.is_empty() {
        return Ok(());
    }
    if q.frames() == 0 {
        return Err(Error::Parameter { name: "new_times", expected: "no times, since there are no samples" });
    }
    let mut path = vec![T::ZERO; q.data().len()];
    continuous(q, ClipMut::new(&mut path, q.frames(), joints)?)?;
    let places: Vec<Place> = new_times.iter().map(|&time| place(times, time)).collect();
    let frames = (TASK / joints).max(1);
    let tasks: Vec<(&[Place], &mut [T])> =
        places.chunks(frames).zip(out.chunks_mut(frames * joints * 4)).collect();
    parallel::for_each(tasks, new_times.len() * joints * 10, |_, (places, out)| {
        interpolate(&path, joints, places, out);
        Ok(())
    })?;
    make_continuous(out, joints)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_placed_in_the_interval_on_their_right() {
        let times = [0.0, 1.0, 3.0];
        for (time, left, part) in [(0.0, 0, 0.0), (0.5, 0, 0.5), (1.0, 1, 0.0), (2.0, 1, 0.5), (3.0, 1, 1.0)]
        {
            let found = place(&times, time);
            assert_eq!((found.left, found.part), (left, part), "{time}");
        }
    }
}
