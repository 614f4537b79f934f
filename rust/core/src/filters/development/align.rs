//! Loads a group of joints as planes, with signs such that quaternions can be averaged.

use super::super::columns::BLOCK;
use crate::clip::Planes;
use crate::rotations::quaternion::dot;
use crate::simd::multiversion;
use crate::{ClipView, Real};
use std::ops::Range;

/// Joints per task: few, because each has planes over the whole clip.
pub(super) const GROUP: usize = 2;

/// Planes of a joint: its quaternions and its confidence.
pub(super) const ROWS: usize = 5;

/// Clarity above which the sign of the first sample is reliable.
const CLEAR: f64 = 0.8;

/// Frames per chunk.
const CHUNK: usize = 64;

/// A chunk of quaternions of one joint, as planes.
type Chunk = [[f64; CHUNK]; 4];

/// Reads unit quaternions of the joints in `range`, and their confidence: [`ROWS`] planes for each.
///
/// Each quaternion is put in the hemisphere of a running mean of the previous ones. Half of the quaternion is then
/// added to the mean, less for a low confidence or a low `clear`. A comparison with the previous sample alone would
/// change the sign of the remaining path too often in noise. In heavy noise a second pass runs back to the first
/// frame in the same way, because the first frame is unreliable.
pub(super) fn load<T: Real>(
    clip: ClipView<'_, T>,
    confidence: Option<&[T]>,
    clarity: &[f64],
    range: Range<usize>,
    planes: &mut Planes<f64>,
) {
    let (frames, row) = (clip.frames(), clip.joints() * 4);
    let joints = range.len();
    planes.reshape(joints * ROWS, frames.next_multiple_of(BLOCK));
    let mut rows = [[T::ONE; GROUP * 4]; CHUNK];
    let mut samples = [[[1.0; CHUNK]; 4]; GROUP];
    let mut halves = [[0.5; CHUNK]; GROUP];
    let mut means = [None; GROUP];
    for start in (0..frames).step_by(CHUNK) {
        let length = CHUNK.min(frames - start);
        // A plain copy first: its loads are independent of each other, and memory is slow.
        for (copy, frame) in rows.iter_mut().zip(clip.slice(start, start + length).data().chunks_exact(row)) {
            let frame = &frame[range.start * 4..range.end * 4];
            match frame.first_chunk() {
                Some(whole) => *copy = *whole,
                None => copy[..frame.len()].copy_from_slice(frame),
            }
        }
        for (joint, samples) in samples[..joints].iter_mut().enumerate() {
            units(&rows, joint, samples);
        }
        if let Some(confidence) = confidence {
            let frames = confidence[start * clip.joints()..].chunks_exact(clip.joints());
            for (i, trust) in frames.take(length).enumerate() {
                for (half, trust) in halves.iter_mut().zip(&trust[range.clone()]) {
                    half[i] = trust.to_f64() * 0.5;
                }
            }
        }
        align(&mut samples[..joints], &halves, &clarity[range.clone()], &mut means, length);
        for (joint, (samples, halves)) in samples[..joints].iter().zip(&halves).enumerate() {
            let [w, x, y, z, trust] = planes.rows_mut::<ROWS>(joint * ROWS);
            for (plane, samples) in [w, x, y, z].into_iter().zip(samples) {
                plane[start..start + length].copy_from_slice(&samples[..length]);
            }
            for (trust, half) in trust[start..start + length].iter_mut().zip(halves) {
                *trust = half + half;
            }
        }
    }
    for (joint, (mean, &clear)) in means.iter().zip(&clarity[range]).enumerate() {
        if let Some(mean) = mean
            && clear < CLEAR
        {
            let [samples @ .., trust] = planes.rows_mut::<ROWS>(joint * ROWS);
            follow_mean(samples, Some(&*trust), clear, *mean, (0..frames).rev());
        }
    }
}

/// Puts the samples of a joint, frame by frame, in the hemisphere of a running mean, and updates the mean.
pub(super) fn follow_mean(
    samples: [&mut [f64]; 4],
    trust: Option<&[f64]>,
    clear: f64,
    mut mean: [f64; 4],
    frames: impl Iterator<Item = usize>,
) {
    let mut samples = samples;
    for i in frames {
        let q = samples.each_ref().map(|plane| plane[i]);
        let q = if dot(mean, q) < 0.0 { q.map(|x| -x) } else { q };
        for (plane, x) in samples.iter_mut().zip(q) {
            plane[i] = x;
        }
        let share = trust.map_or(1.0, |trust| trust[i]) * 0.5 * clear;
        mean = std::array::from_fn(|c| mean[c] + share * (q[c] - mean[c]));
    }
}

multiversion! {
    /// The unit quaternions of one joint of a group.
    fn units<T: Real>(rows: &[[T; GROUP * 4]; CHUNK], joint: usize, out: &mut Chunk) {
        let mut q = [[0.0; CHUNK]; 4];
        for i in 0..CHUNK {
            for c in 0..4 {
                q[c][i] = rows[i][joint * 4 + c].to_f64();
            }
        }
        for i in 0..CHUNK {
            let one = [q[0][i], q[1][i], q[2][i], q[3][i]];
            let length = dot(one, one).sqrt();
            for c in 0..4 {
                out[c][i] = one[c] / length;
            }
        }
    }
}

/// Aligns the signs of the first `length` quaternions of each joint, and updates the running means.
fn align(
    samples: &mut [Chunk],
    halves: &[[f64; CHUNK]; GROUP],
    clarity: &[f64],
    means: &mut [Option<[f64; 4]>],
    length: usize,
) {
    // The joints' chains of sums are independent of each other.
    for i in 0..length {
        let joints = samples.iter_mut().zip(halves).zip(clarity).zip(means.iter_mut());
        for (((samples, halves), clear), kept) in joints {
            let q = [samples[0][i], samples[1][i], samples[2][i], samples[3][i]];
            let mean = kept.unwrap_or(q);
            let sign = if dot(mean, q) < 0.0 { -1.0 } else { 1.0 };
            let q = q.map(|x| sign * x);
            for (samples, q) in samples.iter_mut().zip(q) {
                samples[i] = q;
            }
            let share = halves[i] * clear;
            *kept = Some(std::array::from_fn(|c| mean[c] + share * (q[c] - mean[c])));
        }
    }
}
