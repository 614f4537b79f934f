//! One joint over the whole clip, as planes.

use super::super::columns::{BLOCK, Mask};
use super::spin::{follow_spin, may_spin};
use crate::clip::Planes;
use crate::parallel::Interrupt;
use crate::rotations::quaternion::{between, conjugate_one, dot, exp_one, log_short, product, rotate, unit};
use crate::simd::multiversion;
use crate::window::Boundary;
use crate::{Error, Real};

/// Length of an average of unit quaternions below which its direction is random: the samples rotate through all
/// directions within the mask.
pub(super) const SHORTEST_MEAN: f64 = 0.1;

/// A joint and its reference path. All planes are padded to a multiple of [`BLOCK`] frames.
#[derive(Debug)]
pub(in crate::filters) struct Joint<'a> {
    /// Number of frames.
    pub(in crate::filters) frames: usize,
    /// The aligned unit quaternions `q`.
    pub(in crate::filters) samples: [&'a [f64]; 4],
    /// The unit quaternions `r`.
    pub(in crate::filters) reference: [&'a mut [f64]; 4],
    /// `h`, unit quaternions: from the body frame to the frame of `R` and `y`.
    pub(in crate::filters) frame: [&'a mut [f64]; 4],
    /// Whether the frame is moved along the reference path by parallel transport; otherwise it is the body frame.
    pub(in crate::filters) carried: bool,
    /// `R`, radians.
    pub(in crate::filters) development: [&'a mut [f64]; 3],
    /// `y`, radians.
    pub(in crate::filters) vectors: [&'a mut [f64]; 3],
    /// The confidence of the samples.
    pub(in crate::filters) trust: Option<&'a [f64]>,
}

/// Parameters of the development.
#[derive(Debug, Clone, Copy)]
pub(super) struct Chart<'a> {
    /// The mask of the reference path.
    pub(super) mask: &'a Mask,
    /// Its standard deviation in frames, if spinning joints are slowed down first.
    pub(super) spins: Option<f64>,
    /// Whether the vectors are relative to the frame that is moved along the reference path.
    pub(super) carried: bool,
}

/// Input of a linear filter: the vectors of a joint, or a translation.
///
/// All planes are padded to a multiple of 32 frames, so that masks need no remainder loops.
#[derive(Debug)]
pub struct Columns<'a> {
    /// Number of frames.
    pub frames: usize,
    /// The values to be filtered.
    pub vectors: [&'a mut [f64]; 3],
    /// Their local mean: the development of the reference path.
    pub mean: [&'a [f64]; 3],
    /// The samples' confidence.
    pub trust: Option<&'a [f64]>,
}

impl Columns<'_> {
    /// Moves the vectors towards their local mean, by one minus their confidence.
    pub fn pull(&mut self) {
        if let Some(trust) = self.trust {
            for (vector, mean) in self.vectors.iter_mut().zip(self.mean) {
                pull(vector, mean, trust);
            }
        }
    }
}

impl<'a> Joint<'a> {
    /// Computes the reference path with a mask, and develops it.
    pub(super) fn develop(
        samples: [&'a [f64]; 4],
        trust: Option<&'a [f64]>,
        frames: usize,
        Chart { mask, spins, carried }: Chart<'_>,
        (planes, spare): (&'a mut Planes<f64>, &mut Planes<f64>),
        interrupt: &Interrupt,
    ) -> Result<Self, Error> {
        planes.reshape(14, frames.next_multiple_of(BLOCK));
        let [w, x, y, z, one, i, j, k, a, b, c, vectors @ ..] = planes.rows_mut::<14>(0);
        one.fill(1.0);
        for zero in [&mut *i, &mut *j, &mut *k] {
            zero.fill(0.0);
        }
        let mut reference = [w, x, y, z];
        for (mean, samples) in reference.iter_mut().zip(samples) {
            mean.copy_from_slice(samples);
        }
        mask.means(&mut reference, trust, (frames, Boundary::Mirror), spare, interrupt)?;
        let spins = spins.filter(|_| may_spin(reference.each_ref().map(|plane| &**plane), frames));
        make_unit(reference.each_mut().map(|plane| &mut **plane), samples, SHORTEST_MEAN);
        if let Some(sigma) = spins {
            let path = reference.each_mut().map(|plane| &mut **plane);
            follow_spin(path, (samples, trust), frames, (mask, sigma), spare, interrupt)?;
        }
        let (frame, development) = ([one, i, j, k], [a, b, c]);
        let mut joint = Self { frames, samples, reference, frame, carried, development, vectors, trust };
        joint.roll_out();
        Ok(joint)
    }

    /// Develops the reference path, and the samples relative to it.
    pub(in crate::filters) fn roll_out(&mut self) {
        let reference = self.reference.each_ref().map(|plane| &**plane);
        let mut development = self.development.each_mut().map(|plane| &mut **plane);
        turns(reference, development.each_mut().map(|plane| &mut plane[1..]));
        if self.carried {
            halves(reference, self.frame.each_mut().map(|plane| &mut plane[1..]));
            carry(&mut self.frame, self.frames);
            let frame = self.frame.each_ref().map(|plane| &**plane);
            seen(frame, development.each_mut().map(|plane| &mut plane[1..]));
        }
        add_up(&mut development, self.frames);
        let vectors = self.vectors.each_mut().map(|plane| &mut **plane);
        let frame = self.frame.each_ref().map(|plane| &**plane);
        beside(reference, self.samples, frame, development.each_ref().map(|plane| &**plane), vectors);
    }

    /// A vector of a frame, in body coordinates.
    pub(in crate::filters) fn of_body(&self, frame: usize, vector: [f64; 3]) -> [f64; 3] {
        rotate(conjugate_one(self.frame.each_ref().map(|plane| plane[frame])), vector)
    }

    /// The input of a linear filter.
    pub(in crate::filters) fn columns(&mut self) -> Columns<'_> {
        Columns {
            frames: self.frames,
            vectors: self.vectors.each_mut().map(|plane| &mut **plane),
            mean: self.development.each_ref().map(|plane| &**plane),
            trust: self.trust,
        }
    }

    /// Moves the reference path to the filtered vectors.
    pub(in crate::filters) fn follow_vectors(&mut self) {
        follow(
            self.frame.each_ref().map(|plane| &**plane),
            self.development.each_ref().map(|plane| &**plane),
            self.vectors.each_ref().map(|plane| &**plane),
            self.reference.each_mut().map(|plane| &mut **plane),
        );
    }
}

multiversion! {
    /// Normalises quaternions; those shorter than `shortest` are replaced by the samples.
    pub(super) fn make_unit<T: Real>(q: [&mut [T]; 4], samples: [&[T]; 4], shortest: T) {
        let n = q[0].len();
        let samples = samples.map(|plane| &plane[..n]);
        let [w, x, y, z] = q.map(|plane| &mut plane[..n]);
        for i in 0..n {
            let mean = [w[i], x[i], y[i], z[i]];
            let length = dot(mean, mean).sqrt();
            let clear = length >= shortest;
            let one = std::array::from_fn::<T, 4, _>(|c| if clear { mean[c] / length } else { samples[c][i] });
            w[i] = one[0];
            x[i] = one[1];
            y[i] = one[2];
            z[i] = one[3];
        }
    }
}

multiversion! {
    /// Rotation vectors from each frame to the next, of the shorter rotation.
    pub(super) fn turns<T: Real>(q: [&[T]; 4], out: [&mut [T]; 3]) {
        let n = out[0].len();
        let here = q.map(|plane| &plane[..n]);
        let next = q.map(|plane| &plane[1..=n]);
        let [x, y, z] = out.map(|plane| &mut plane[..n]);
        for i in 0..n {
            let a = [here[0][i], here[1][i], here[2][i], here[3][i]];
            let b = [next[0][i], next[1][i], next[2][i], next[3][i]];
            let turn = log_short(between(a, b));
            x[i] = T::TWO * turn[0];
            y[i] = T::TWO * turn[1];
            z[i] = T::TWO * turn[2];
        }
    }
}

multiversion! {
    /// Half of the shorter rotation from each frame to the next, as unit quaternions.
    fn halves<T: Real>(q: [&[T]; 4], out: [&mut [T]; 4]) {
        let n = out[0].len();
        let here = q.map(|plane| &plane[..n]);
        let next = q.map(|plane| &plane[1..=n]);
        let [w, x, y, z] = out.map(|plane| &mut plane[..n]);
        for i in 0..n {
            let a = [here[0][i], here[1][i], here[2][i], here[3][i]];
            let b = [next[0][i], next[1][i], next[2][i], next[3][i]];
            let turn = between(a, b);
            let sign = T::ONE.copysign(turn[0]);
            let half = unit([turn[0].abs() + T::ONE, sign * turn[1], sign * turn[2], sign * turn[3]]);
            w[i] = half[0];
            x[i] = half[1];
            y[i] = half[2];
            z[i] = half[3];
        }
    }
}

/// Products of the half rotations up to each frame, in place: parallel transport rotates the body frame by half of
/// each rotation.
pub(super) fn carry(halves: &mut [&mut [f64]; 4], frames: usize) {
    let [w, x, y, z] = halves.each_mut().map(|plane| &mut plane[..frames]);
    let mut here = [1.0, 0.0, 0.0, 0.0];
    w[0] = 1.0;
    x[0] = 0.0;
    y[0] = 0.0;
    z[0] = 0.0;
    for i in 1..frames {
        let next = product(here, [w[i], x[i], y[i], z[i]]);
        // Newton's step towards length 1: rounding errors do not accumulate, and no square root is needed.
        let scale = 1.5 - 0.5 * dot(next, next);
        here = next.map(|x| scale * x);
        w[i] = here[0];
        x[i] = here[1];
        y[i] = here[2];
        z[i] = here[3];
    }
}

multiversion! {
    /// Vectors in the coordinates of other frames, in place.
    pub(super) fn seen<T: Real>(frame: [&[T]; 4], vectors: [&mut [T]; 3]) {
        let n = vectors[0].len();
        let frame = frame.map(|plane| &plane[..n]);
        let [x, y, z] = vectors.map(|plane| &mut plane[..n]);
        for i in 0..n {
            let vector = rotate([frame[0][i], frame[1][i], frame[2][i], frame[3][i]], [x[i], y[i], z[i]]);
            x[i] = vector[0];
            y[i] = vector[1];
            z[i] = vector[2];
        }
    }
}

/// Cumulative sums of the rotation vectors, in place; the first is 0.
fn add_up(turns: &mut [&mut [f64]; 3], frames: usize) {
    let [x, y, z] = turns.each_mut().map(|plane| &mut plane[..frames]);
    let mut sum = [0.0; 3];
    x[0] = 0.0;
    y[0] = 0.0;
    z[0] = 0.0;
    for i in 1..frames {
        sum = [sum[0] + x[i], sum[1] + y[i], sum[2] + z[i]];
        x[i] = sum[0];
        y[i] = sum[1];
        z[i] = sum[2];
    }
}

multiversion! {
    /// The samples as vectors relative to the development of the reference path.
    fn beside<T: Real>(
        reference: [&[T]; 4],
        samples: [&[T]; 4],
        frame: [&[T]; 4],
        development: [&[T]; 3],
        out: [&mut [T]; 3],
    ) {
        let n = out[0].len();
        let frame = frame.map(|plane| &plane[..n]);
        let (reference, samples) = (reference.map(|plane| &plane[..n]), samples.map(|plane| &plane[..n]));
        let development = development.map(|plane| &plane[..n]);
        let [x, y, z] = out.map(|plane| &mut plane[..n]);
        for i in 0..n {
            let a = [reference[0][i], reference[1][i], reference[2][i], reference[3][i]];
            let b = [samples[0][i], samples[1][i], samples[2][i], samples[3][i]];
            let seen_from = [frame[0][i], frame[1][i], frame[2][i], frame[3][i]];
            let way = rotate(seen_from, log_short(between(a, b)));
            x[i] = development[0][i] + T::TWO * way[0];
            y[i] = development[1][i] + T::TWO * way[1];
            z[i] = development[2][i] + T::TWO * way[2];
        }
    }
}

multiversion! {
    /// Moves a path by half of the difference between its vectors and its development.
    fn follow<T: Real>(frame: [&[T]; 4], development: [&[T]; 3], vectors: [&[T]; 3], path: [&mut [T]; 4]) {
        let n = path[0].len();
        let frame = frame.map(|plane| &plane[..n]);
        let (development, vectors) = (development.map(|plane| &plane[..n]), vectors.map(|plane| &plane[..n]));
        let [w, x, y, z] = path.map(|plane| &mut plane[..n]);
        for i in 0..n {
            let half = std::array::from_fn::<T, 3, _>(|c| (vectors[c][i] - development[c][i]) * T::HALF);
            let body = conjugate_one([frame[0][i], frame[1][i], frame[2][i], frame[3][i]]);
            let half = rotate(body, half);
            let one = product([w[i], x[i], y[i], z[i]], exp_one(half));
            w[i] = one[0];
            x[i] = one[1];
            y[i] = one[2];
            z[i] = one[3];
        }
    }
}

multiversion! {
    /// Moves values towards their means, by one minus their confidence.
    fn pull<T: Real>(numbers: &mut [T], means: &[T], trust: &[T]) {
        let n = numbers.len();
        let (means, trust) = (&means[..n], &trust[..n]);
        for i in 0..n {
            numbers[i] = means[i] + trust[i] * (numbers[i] - means[i]);
        }
    }
}
