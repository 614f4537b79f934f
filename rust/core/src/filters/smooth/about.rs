//! The vectors of all joints about a pilot, and the way back.
//!
//! A clip may be long: vectors are there for a few thousand frames at a time. Each such part has a development of its own, which
//! begins at 0; what is computed of it does not depend on where it begins.

use super::LEAST_NOISE;
use crate::clip::Planes;
use crate::error::check_length;
use crate::filters::columns::BLOCK;
use crate::parallel::{self, Interrupt};
use crate::rotations::continuity::make_continuous;
use crate::rotations::quaternion::{between, dot, exp_one, log_short, negative, product, unit};
use crate::simd::multiversion;
use crate::{ClipView, Error, Real};
use std::ops::Range;

/// Frames per task of the way back.
pub(super) const TASK: usize = 1024;

/// Frames that are read together: their rows stay in the first-level cache.
const CHUNK: usize = 64;

/// Estimated nanoseconds per sample of the way to the vectors, and of that back.
const NANOSECONDS: usize = 40;

/// Quaternions of a chunk, as planes.
type Samples = [[f64; CHUNK]; 4];

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

/// Vectors of one joint in some frames, in units of its noise: six planes, padded to a multiple of [`BLOCK`] frames.
#[derive(Debug, Default)]
pub(super) struct About(Planes<f64>);

impl About {
    /// The development of the pilot, 0 in the first of the frames.
    pub(super) fn mean(&self) -> [&[f64]; 3] {
        self.0.rows_from(0)
    }

    /// From the pilot to the samples.
    pub(super) fn beside(&self) -> [&[f64]; 3] {
        self.0.rows_from(3)
    }
}

impl<T: Real> Noisy<'_, T> {
    /// Refuses slices that do not fit together.
    pub(super) fn check(&self) -> Result<(), Error> {
        check_length("pilot", self.clip.data().len(), self.pilot.data().len())?;
        check_length("noise", self.clip.joints(), self.noise.len())?;
        let samples = self.clip.frames() * self.clip.joints();
        self.confidence.map_or(Ok(()), |trust| check_length("confidence", samples, trust.len()))
    }

    /// The joints that have at least so much noise.
    pub(super) fn joints(&self, least: f64) -> Vec<usize> {
        let least = least.max(LEAST_NOISE);
        (0..self.clip.joints()).filter(|&joint| self.noise[joint] >= least).collect()
    }

    /// The vectors of some joints in some frames, into the memory of others.
    pub(super) fn vectors(
        &self,
        joints: &[usize],
        frames: Range<usize>,
        about: &mut Vec<About>,
        interrupt: &Interrupt,
    ) -> Result<(), Error> {
        about.resize_with(joints.len(), About::default);
        let tasks: Vec<_> = about.iter_mut().zip(joints).collect();
        parallel::for_each(tasks, frames.len() * joints.len() * NANOSECONDS, |_, (about, &joint)| {
            interrupt.check()?;
            self.joint_vectors(joint, frames.clone(), about);
            Ok(())
        })
    }

    /// The vectors of one joint in some frames.
    pub(super) fn joint_vectors(&self, joint: usize, frames: Range<usize>, About(planes): &mut About) {
        planes.reshape(6, frames.len().next_multiple_of(BLOCK));
        let scale = 2.0 / self.noise[joint];
        let mut sum = [0.0; 3];
        let mut trust = [1.0; CHUNK];
        for start in frames.clone().step_by(CHUNK) {
            let length = CHUNK.min(frames.end - start);
            let [mut from, mut to, mut sample] = [[[1.0; CHUNK]; 4]; 3];
            load(self.pilot, start.saturating_sub(1).max(frames.start), joint, &mut from);
            load(self.pilot, start, joint, &mut to);
            load(self.clip, start, joint, &mut sample);
            if start == frames.start {
                // The first frame has none before it.
                let first = to.map(|plane| plane[0]);
                for (plane, (after, first)) in from.iter_mut().zip(to.iter().zip(first)) {
                    plane[1..].copy_from_slice(&after[..CHUNK - 1]);
                    plane[0] = first;
                }
            }
            if let Some(confidence) = self.confidence {
                let path =
                    confidence[start * self.clip.joints() + joint..].iter().step_by(self.clip.joints());
                for (trust, from) in trust.iter_mut().zip(path) {
                    *trust = from.to_f64();
                }
            }
            let (mut turns, mut ways) = ([[0.0; CHUNK]; 3], [[0.0; CHUNK]; 3]);
            logarithms(&from, &to, &[1.0; CHUNK], scale, &mut turns);
            logarithms(&to, &sample, &trust, scale, &mut ways);
            let within = start - frames.start;
            for c in 0..3 {
                for (x, turn) in planes.row_mut(c)[within..within + length].iter_mut().zip(&turns[c]) {
                    sum[c] += turn;
                    *x = sum[c];
                }
                planes.row_mut(3 + c)[within..within + length].copy_from_slice(&ways[c][..length]);
            }
        }
    }

    /// Writes the steps of the development of some joints from each frame of a range to the next, in units of their noise: rows of
    /// `width` numbers, three for each joint.
    pub(super) fn steps(&self, joints: &[usize], frames: Range<usize>, width: usize, rows: &mut [f64]) {
        for (i, &joint) in joints.iter().enumerate() {
            let scale = 2.0 / self.noise[joint];
            for start in frames.clone().step_by(CHUNK) {
                let length = CHUNK.min(frames.end - start);
                let [mut from, mut to] = [[[1.0; CHUNK]; 4]; 2];
                load(self.pilot, start, joint, &mut from);
                load(self.pilot, start + 1, joint, &mut to);
                let mut turns = [[0.0; CHUNK]; 3];
                logarithms(&from, &to, &[1.0; CHUNK], scale, &mut turns);
                let rows = rows[(start - frames.start) * width..].chunks_exact_mut(width);
                for (t, row) in rows.take(length).enumerate() {
                    for c in 0..3 {
                        row[i * 3 + c] = turns[c][t];
                    }
                }
            }
        }
    }

    /// Moves the pilot by the vectors of some joints, in units of their noise, into `out`, frames from `first` on.
    ///
    /// `by` tells the plane of a joint's coordinate; its first number is that of the frame `first`.
    pub(super) fn moved<'b>(
        &self,
        joints: &[usize],
        first: usize,
        by: impl Fn(usize, usize) -> &'b [f64],
        out: &mut [T],
    ) {
        let row = self.clip.joints() * 4;
        for (chunk, out) in out.chunks_mut(CHUNK * row).enumerate() {
            let within = chunk * CHUNK;
            let length = out.len() / row;
            let (rows, _) = out.as_chunks_mut::<4>();
            let mut moving = joints.iter().enumerate().peekable();
            for joint in 0..self.clip.joints() {
                let mut q = [[1.0; CHUNK]; 4];
                load(self.pilot, first + within, joint, &mut q);
                if let Some((i, _)) = moving.next_if(|&(_, &next)| next == joint) {
                    let mut way = [[0.0; CHUNK]; 3];
                    for (c, way) in way.iter_mut().enumerate() {
                        way[..length].copy_from_slice(&by(i, c)[within..within + length]);
                    }
                    turn(&mut q, &way, self.noise[joint] * 0.5);
                } else {
                    units(&mut q);
                }
                let path = rows[joint..].iter_mut().step_by(self.clip.joints());
                for (i, to) in path.enumerate() {
                    *to = [q[0][i], q[1][i], q[2][i], q[3][i]].map(T::from_f64);
                }
            }
        }
    }

    /// Runs `work` for parts of frames: the first of them, and their samples in `out`.
    pub(super) fn each_part(
        &self,
        frames: usize,
        out: &mut [T],
        nanoseconds: usize,
        work: impl Fn(usize, &mut [T]) -> Result<(), Error> + Sync + Send,
    ) -> Result<(), Error> {
        let row = self.clip.joints() * 4;
        let samples = out.len() / 4;
        let tasks: Vec<&mut [T]> = out.chunks_mut(frames * row).collect();
        parallel::for_each(tasks, samples * (NANOSECONDS + nanoseconds), |task, out| work(task * frames, out))
    }

    /// Writes the pilot.
    pub(super) fn unmoved(&self, out: &mut [T]) -> Result<(), Error> {
        self.each_part(TASK, out, 0, |first, out| {
            self.moved(&[], first, |_, _| &[], out);
            Ok(())
        })?;
        self.sign(out)
    }

    /// Makes a result continuous in sign from the hemisphere of the first frame of the clip.
    pub(super) fn sign(&self, out: &mut [T]) -> Result<(), Error> {
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

/// Reads the quaternions of a joint from a frame on; beyond the end of the clip nothing is read.
fn load<T: Real>(clip: ClipView<'_, T>, first: usize, joint: usize, out: &mut Samples) {
    let (rows, _) = clip.data().as_chunks::<4>();
    let path = rows[first * clip.joints()..].chunks_exact(clip.joints());
    let [w, x, y, z] = out;
    for (i, row) in path.take(CHUNK).enumerate() {
        let q = row[joint];
        w[i] = q[0].to_f64();
        x[i] = q[1].to_f64();
        y[i] = q[2].to_f64();
        z[i] = q[3].to_f64();
    }
}

multiversion! {
    /// Rotation vectors from one quaternion to another, the shorter way, each times half a factor of its own and one of all.
    fn logarithms<T: Real>(
        from: &[[T; CHUNK]; 4], to: &[[T; CHUNK]; 4], shares: &[T; CHUNK], scale: T, out: &mut [[T; CHUNK]; 3],
    ) {
        for i in 0..CHUNK {
            let a = unit([from[0][i], from[1][i], from[2][i], from[3][i]]);
            let b = unit([to[0][i], to[1][i], to[2][i], to[3][i]]);
            let way = log_short(between(a, b));
            for c in 0..3 {
                out[c][i] = way[c] * scale * shares[i];
            }
        }
    }
}

multiversion! {
    /// Turns quaternions by vectors times a factor, and makes them unit ones.
    fn turn<T: Real>(q: &mut [[T; CHUNK]; 4], way: &[[T; CHUNK]; 3], scale: T) {
        for i in 0..CHUNK {
            let by = exp_one([way[0][i] * scale, way[1][i] * scale, way[2][i] * scale]);
            let one = unit(product([q[0][i], q[1][i], q[2][i], q[3][i]], by));
            for c in 0..4 {
                q[c][i] = one[c];
            }
        }
    }
}

multiversion! {
    fn units<T: Real>(q: &mut [[T; CHUNK]; 4]) {
        let [w, x, y, z] = q;
        for i in 0..CHUNK {
            [w[i], x[i], y[i], z[i]] = unit([w[i], x[i], y[i], z[i]]);
        }
    }
}
