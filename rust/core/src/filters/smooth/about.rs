//! The vectors of all joints about a pilot, and the way back.

use super::LEAST_NOISE;
use crate::clip::Planes;
use crate::error::check_length;
use crate::filters::columns::BLOCK;
use crate::parallel::{self, Interrupt};
use crate::rotations::continuity::make_continuous;
use crate::rotations::quaternion::{between, dot, exp_one, log_short, negative, product, unit};
use crate::simd::multiversion;
use crate::{ClipView, Error, Real};

/// Frames per task of the way back.
const TASK: usize = 1024;

/// Frames that are read together: their rows stay in the first-level cache.
pub(super) const CHUNK: usize = 64;

/// A clip, an estimate of it, and how much its samples are trusted.
#[derive(Debug, Clone, Copy)]
pub struct Noisy<'a, T> {
    /// Rotations without missing samples; they need not have length 1 exactly.
    pub clip: ClipView<'a, T>,
    /// An estimate of them, of the same shape.
    pub pilot: ClipView<'a, T>,
    /// `(frames, joints)`, from 0 to 1: by as much as it lacks a sample is pulled to the pilot.
    pub confidence: Option<&'a [T]>,
    /// Deviation of the noise per component of the rotation vector in radians, for each joint; 0: the joint stays as the pilot
    /// has it.
    pub noise: &'a [f64],
}

/// Vectors of the noisy joints in units of their noise, three planes for each, padded to a multiple of [`BLOCK`] frames.
#[derive(Debug)]
pub(super) struct About {
    /// Which joints are noisy.
    pub(super) joints: Vec<usize>,
    /// The development of the pilot.
    pub(super) mean: Vec<Planes<f64>>,
    /// From the pilot to the samples.
    pub(super) beside: Vec<Planes<f64>>,
}

impl<T: Real> Noisy<'_, T> {
    /// Refuses slices that do not fit together.
    pub(super) fn check(&self) -> Result<(), Error> {
        check_length("pilot", self.clip.data().len(), self.pilot.data().len())?;
        check_length("noise", self.clip.joints(), self.noise.len())?;
        let samples = self.clip.frames() * self.clip.joints();
        self.confidence.map_or(Ok(()), |trust| check_length("confidence", samples, trust.len()))
    }

    /// The vectors of the joints that are noisy.
    pub(super) fn vectors(&self, interrupt: &Interrupt) -> Result<About, Error> {
        let frames = self.clip.frames();
        let joints: Vec<usize> =
            (0..self.clip.joints()).filter(|&joint| self.noise[joint] >= LEAST_NOISE).collect();
        let planes = parallel::map(joints.clone(), frames * joints.len() * 60, |_, joint| {
            interrupt.check()?;
            Ok(self.joint(joint))
        })?;
        let (mean, beside) = planes.into_iter().unzip();
        Ok(About { joints, mean, beside })
    }

    fn joint(&self, joint: usize) -> (Planes<f64>, Planes<f64>) {
        let frames = self.clip.frames();
        let padded = frames.next_multiple_of(BLOCK);
        let (mut mean, mut beside) = (Planes::new(3, padded), Planes::new(3, padded));
        let scale = 2.0 / self.noise[joint];
        let mut sum = [0.0; 3];
        let mut before = unit(self.pilot.at(0, joint).map(T::to_f64));
        for start in (0..frames).step_by(CHUNK) {
            let length = CHUNK.min(frames - start);
            let mut samples = [[[0.0; CHUNK]; 4]; 3];
            let [from, to, sample] = &mut samples;
            for i in 0..length {
                let frame = start + i;
                let here = unit(self.pilot.at(frame, joint).map(T::to_f64));
                let noisy = unit(self.clip.at(frame, joint).map(T::to_f64));
                for c in 0..4 {
                    from[c][i] = before[c];
                    to[c][i] = here[c];
                    sample[c][i] = noisy[c];
                }
                before = here;
            }
            let (mut turns, mut ways) = ([[0.0; CHUNK]; 3], [[0.0; CHUNK]; 3]);
            logarithms(from, to, &mut turns);
            logarithms(to, sample, &mut ways);
            for i in 0..length {
                let trust = self
                    .confidence
                    .map_or(1.0, |trust| trust[(start + i) * self.clip.joints() + joint].to_f64());
                for c in 0..3 {
                    sum[c] += turns[c][i] * scale;
                    mean.row_mut(c)[start + i] = sum[c];
                    beside.row_mut(c)[start + i] = ways[c][i] * scale * trust;
                }
            }
        }
        (mean, beside)
    }

    /// Moves the pilot by the vectors of the noisy joints, in units of their noise, into `out`, sign-continuous from the
    /// hemisphere of the first frame of the clip.
    pub(super) fn moved(&self, joints: &[usize], by: &[Planes<f64>], out: &mut [T]) -> Result<(), Error> {
        let (frames, row) = (self.clip.frames(), self.clip.joints() * 4);
        let tasks: Vec<&mut [T]> = out.chunks_mut(TASK * row).collect();
        parallel::for_each(tasks, frames * self.clip.joints() * 40, |task, out| {
            for (i, out) in out.chunks_exact_mut(row).enumerate() {
                let frame = task * TASK + i;
                out.copy_from_slice(self.pilot.slice(frame, frame + 1).data());
                let (rows, _) = out.as_chunks_mut::<4>();
                for (&joint, by) in joints.iter().zip(by) {
                    let half = self.noise[joint] * 0.5;
                    let way = by.rows_from::<3>(0).map(|plane| plane[frame] * half);
                    let moved = product(rows[joint].map(T::to_f64), exp_one(way));
                    rows[joint] = moved.map(T::from_f64);
                }
                for q in rows {
                    *q = unit(*q);
                }
            }
            Ok(())
        })?;
        let (result, _) = out.as_chunks_mut::<4>();
        let (first, _) = self.clip.data().as_chunks::<4>();
        for (q, first) in result.iter_mut().zip(first).take(self.clip.joints()) {
            if dot(*q, *first) < T::ZERO {
                *q = negative(*q);
            }
        }
        make_continuous(out, self.clip.joints())
    }
}

multiversion! {
    /// Half rotation vectors from one unit quaternion to another, the shorter way.
    pub(super) fn logarithms<T: Real>(from: &[[T; CHUNK]; 4], to: &[[T; CHUNK]; 4], out: &mut [[T; CHUNK]; 3]) {
        for i in 0..CHUNK {
            let a = [from[0][i], from[1][i], from[2][i], from[3][i]];
            let b = [to[0][i], to[1][i], to[2][i], to[3][i]];
            let way = log_short(between(a, b));
            for c in 0..3 {
                out[c][i] = way[c];
            }
        }
    }
}
