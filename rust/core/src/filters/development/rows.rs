//! Transposes planes and joint-by-joint results to rows, frame by frame.

use super::joint::Joint;
use crate::error::check_length;
use crate::parallel;
use crate::rotations::continuity::make_continuous;
use crate::rotations::quaternion::{dot, exp_one, negative, product, unit};
use crate::{ClipMut, ClipView, Error, Real};
use std::ops::Range;

/// Frames per task.
const TASK: usize = 2048;

/// Frames that are transposed together: in float32 and for a whole body they fit in the first-level cache.
const CHUNK: usize = 32;

/// Writes the reference path of a joint as rows, sign-continuous from the hemisphere of `first`.
pub(in crate::filters) fn store<T: Real>(joint: &Joint<'_>, first: [T; 4], rows: &mut [T]) {
    let mut before = first.map(T::to_f64);
    let [w, x, y, z] = joint.reference.each_ref().map(|plane| &plane[..joint.frames]);
    let (rows, _) = rows.as_chunks_mut::<4>();
    for (i, row) in rows.iter_mut().enumerate().take(joint.frames) {
        let one = [w[i], x[i], y[i], z[i]];
        let sign = if dot(one, before) < 0.0 { -1.0 } else { 1.0 };
        before = one.map(|x| sign * x);
        *row = before.map(T::from_f64);
    }
}

/// Copies `columns` from rows of `width` values, stored joint by joint for the joints in `range`, to the elements of
/// these joints, frame by frame, `(frames, joints, columns)`.
pub(in crate::filters) fn interleave<T: Real>(
    from: &[T],
    (width, columns): (usize, Range<usize>),
    range: Range<usize>,
    joints: usize,
    out: &mut [T],
) -> Result<(), Error> {
    let count = columns.len();
    let row = joints * count;
    if out.is_empty() {
        return Ok(());
    }
    let frames = out.len() / row;
    let tasks: Vec<&mut [T]> = out.chunks_mut(TASK * row).collect();
    parallel::for_each(tasks, frames * range.len() * count, |task, out| {
        for (chunk, out) in out.chunks_mut(CHUNK * row).enumerate() {
            let start = task * TASK + chunk * CHUNK;
            for (place, joint) in range.clone().enumerate() {
                let source = from[(place * frames + start) * width..].chunks_exact(width);
                for (row, source) in out.chunks_exact_mut(row).zip(source) {
                    row[joint * count..][..count].copy_from_slice(&source[columns.clone()]);
                }
            }
        }
        Ok(())
    })
}

/// Converts vectors `(frames, joints, 3)` back to rotations: `r_t exp((y_t − R_t) / 2)`, sign-continuous from the
/// hemispheres of the first frame of `clip`.
///
/// # Errors
/// [`Error::Length`] if the lengths of slices do not agree.
pub fn undevelop<T: Real>(
    clip: ClipView<'_, T>,
    reference: &[f64],
    development: &[f64],
    vectors: &[f64],
    out: ClipMut<'_, T>,
) -> Result<(), Error> {
    let joints = clip.joints();
    let samples = clip.frames() * joints;
    check_length("reference", samples * 4, reference.len())?;
    check_length("development", samples * 3, development.len())?;
    check_length("vectors", samples * 3, vectors.len())?;
    let out = out.into_data();
    check_length("out", samples * 4, out.len())?;
    let (clip, _) = clip.data().as_chunks::<4>();
    let (reference, _) = reference.as_chunks::<4>();
    let (development, _) = development.as_chunks::<3>();
    let (vectors, _) = vectors.as_chunks::<3>();
    let task = TASK * joints.max(1);
    parallel::for_each(out.chunks_mut(task * 4).collect(), samples * 40, |index, out: &mut [T]| {
        let (out, _) = out.as_chunks_mut::<4>();
        let range = index * task..index * task + out.len();
        let paths = reference[range.clone()].iter().zip(&development[range.clone()]).zip(&vectors[range]);
        for (out, ((r, from), to)) in out.iter_mut().zip(paths) {
            let half = std::array::from_fn(|c| (to[c] - from[c]) * 0.5);
            *out = unit(product(*r, exp_one(half))).map(T::from_f64);
        }
        Ok(())
    })?;
    let (result, _) = out.as_chunks_mut::<4>();
    for (q, first) in result.iter_mut().zip(clip).take(joints) {
        if dot(*q, *first) < T::ZERO {
            *q = negative(*q);
        }
    }
    make_continuous(out, joints)
}
