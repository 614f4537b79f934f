//! Sign continuity: of `q` and `−q`, which are the same rotation, the one nearer to the previous sample.
//!
//! Each tile of frames is made continuous separately. The sign of a whole tile follows from its first sample and the
//! last one of the previous tiles. Signs are exact, so the result does not depend on the tiles.

use super::quaternion::{dot, is_missing, negative, of_row};
use crate::error::check_length;
use crate::simd::multiversion;
use crate::{ClipMut, ClipView, Error, Real, parallel};

/// Samples per task.
const TILE: usize = 32 * 1024;

/// Both ends of a tile, per joint: its first and last valid samples in the input, zeros if all are missing.
struct Ends<T> {
    first: Vec<[T; 4]>,
    last: Vec<Last<T>>,
}

/// The last valid sample of a joint in the input, and whether its sign was flipped.
#[derive(Debug, Clone, Copy, Default)]
struct Last<T> {
    sample: [T; 4],
    flipped: bool,
}

/// Whether `a · b < 0`, in float64, so that rounding does not decide the sign.
#[inline(always)]
fn opposite<T: Real>(a: [T; 4], b: [T; 4]) -> bool {
    dot(a.map(T::to_f64), b.map(T::to_f64)) < 0.0
}

multiversion! {
    /// Makes `out` continuous, frame by frame; `last` are the last samples before the tile on entry, and those of the
    /// tile on return.
    fn unroll<T: Real>(out: &mut [T], last: &mut [Last<T>]) {
        for frame in out.chunks_exact_mut(last.len() * 4) {
            for (row, last) in frame.chunks_exact_mut(4).zip(last.iter_mut()) {
                let q = of_row(row);
                let valid = !is_missing(q);
                let flip = valid & (last.flipped ^ opposite(q, last.sample));
                let turned = negative(q);
                for c in 0..4 {
                    row[c] = if flip { turned[c] } else { q[c] };
                    last.sample[c] = if valid { q[c] } else { last.sample[c] };
                }
                last.flipped = if valid { flip } else { last.flipped };
            }
        }
    }
}

/// The first valid sample of each joint.
fn first_valid<T: Real>(tile: &[T], joints: usize) -> Vec<[T; 4]> {
    let one = |joint: usize| {
        let mut path = tile.chunks_exact(joints * 4).map(|frame| of_row(&frame[joint * 4..]));
        path.find(|&q| !is_missing(q)).unwrap_or_default()
    };
    (0..joints).map(one).collect()
}

/// Makes `clip` continuous in sign, in place, after copying it from `source` if that is given.
fn unroll_tiles<T: Real>(source: Option<&[T]>, clip: &mut [T], joints: usize) -> Result<(), Error> {
    if clip.is_empty() {
        return Ok(());
    }
    let row = joints * 4;
    let tile = (TILE / joints).max(1) * row;
    let samples = clip.len() / 4;
    let ends = parallel::map(clip.chunks_mut(tile).collect(), samples * 8, |i, part: &mut [T]| {
        if let Some(source) = source {
            part.copy_from_slice(&source[i * tile..i * tile + part.len()]);
        }
        let first = first_valid(part, joints);
        let mut last = vec![Last::default(); joints];
        unroll(part, &mut last);
        Ok(Ends { first, last })
    })?;
    let mut before: Vec<Last<T>> = vec![Last::default(); joints];
    let mut turned = Vec::new();
    for (tile, ends) in clip.chunks_mut(tile).zip(ends) {
        let mut flips: Vec<bool> = Vec::with_capacity(joints);
        for ((before, first), last) in before.iter_mut().zip(ends.first).zip(ends.last) {
            let flip = before.flipped ^ opposite(before.sample, first);
            flips.push(flip);
            if !is_missing(last.sample) {
                *before = Last { sample: last.sample, flipped: last.flipped ^ flip };
            }
        }
        if flips.contains(&true) {
            turned.push((tile, flips));
        }
    }
    let samples = turned.iter().map(|(tile, _)| tile.len() / 4).sum::<usize>();
    parallel::for_each(turned, samples * 2, |_, (tile, flips)| {
        for frame in tile.chunks_exact_mut(row) {
            for (row, &flip) in frame.chunks_exact_mut(4).zip(&flips) {
                let q = of_row(row);
                if flip & !is_missing(q) {
                    row.copy_from_slice(&negative(q));
                }
            }
        }
        Ok(())
    })
}

/// Flips signs so that consecutive valid samples of a joint have an inner product `≥ 0`.
///
/// The first valid sample keeps its sign. If two samples are exactly 180° apart, the sign does not change. Missing
/// samples are unchanged, and continuity extends across them.
///
/// # Errors
/// [`Error::Length`] if the clips differ in length.
pub fn continuous<T: Real>(q: ClipView<'_, T>, out: ClipMut<'_, T>) -> Result<(), Error> {
    let joints = q.joints();
    let out = out.into_data();
    check_length("out", q.data().len(), out.len())?;
    unroll_tiles(Some(q.data()), out, joints)
}

/// [`continuous`] in place, on `(frames, joints, 4)`.
pub(crate) fn make_continuous<T: Real>(clip: &mut [T], joints: usize) -> Result<(), Error> {
    unroll_tiles(None, clip, joints)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A path with small rotations between samples, and with pseudo-random signs and gaps.
    fn path(frames: usize, joints: usize) -> Vec<f64> {
        let mut state = 1_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            state >> 60
        };
        let sample = |i: usize| {
            let (angle, r) = ((i / joints) as f64 * 0.001, random());
            let sign = if r % 2 == 0 { 1.0 } else { -1.0 };
            let q = if r == 3 { [f64::NAN; 4] } else { [1.0, angle, -angle, 0.5] };
            q.map(|x| x * sign)
        };
        (0..frames * joints).flat_map(sample).collect()
    }

    #[test]
    fn tiles_do_not_show() {
        for (frames, joints) in [(1, 1), (3 * TILE + 1, 1), (4 * TILE / 5, 5)] {
            let q = path(frames, joints);
            let mut out = vec![0.0; q.len()];
            let view = ClipView::new(&q, frames, joints).expect("the length fits");
            continuous(view, ClipMut::new(&mut out, frames, joints).expect("the length fits"))
                .expect("nothing can fail");
            let mut alone = q.clone();
            unroll(&mut alone, &mut vec![Last::default(); joints]);
            let bits = |x: &[f64]| x.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
            assert!(bits(&out) == bits(&alone), "{frames} frames, {joints} joints");
        }
    }
}
