//! The bilateral filter of a stream: one window per pass; each pass filters the result of the previous one.

use super::ends::{Ends, Window};
use super::pose::{Pose, Ring, plane, width};
use super::{Causal, MOST_NUMBERS, PoseStream};
use crate::filters::bilateral::{Bilateral, Kernel, LARGEST_FACTOR};
use crate::rotations::quaternion::{angle_between, between, exp_one, log_short, product, unit};
use crate::simd::multiversion;
use crate::{Error, Real};

/// Planes of a frame: its unit quaternions, and the half rotation vectors from the previous frame.
const PLANES: usize = 7;

impl Bilateral {
    /// The filter as a stream, over poses with a joint for each scale of angles.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a boundary that requires later frames, and for too much memory.
    pub fn stream(&self) -> Result<PoseStream, Error> {
        let joints = self.sigma_angle.len();
        let frames = self.radius.saturating_mul(2).saturating_add(1);
        let numbers = frames.saturating_mul(width(joints).max(1) * PLANES).saturating_mul(self.iterations);
        if numbers > MOST_NUMBERS {
            return Err(Error::Parameter {
                name: "radius",
                expected: "a window whose passes fit into 2 GiB",
            });
        }
        let passes = (0..self.iterations).map(|_| Ends::new(Pass::new(self), self.boundary, joints));
        let passes = passes.collect::<Result<Vec<_>, Error>>()?;
        let between = [Pose::new(joints), Pose::new(joints)];
        Ok(PoseStream::new(Passes { passes, between }, joints))
    }
}

/// The passes in order.
struct Passes {
    passes: Vec<Ends<Pass>>,
    between: [Pose; 2],
}

impl Passes {
    /// Runs the result of the pass before `first`, in `between[0]`, through the remaining passes.
    fn pass_on(&mut self, first: usize, out: &mut Pose) -> bool {
        let [taken, given] = &mut self.between;
        for pass in &mut self.passes[first..] {
            if !pass.push(taken, given) {
                return false;
            }
            std::mem::swap(taken, given);
        }
        out.copy_from(taken);
        true
    }
}

impl Causal for Passes {
    fn latency(&self) -> usize {
        self.passes.iter().map(Causal::latency).sum()
    }

    fn appear(&mut self, joint: usize, q: [f64; 4]) {
        // A joint that has not moved is the same after each pass.
        for pass in &mut self.passes {
            pass.appear(joint, q);
        }
    }

    fn push(&mut self, pose: &Pose, out: &mut Pose) -> bool {
        self.between[0].copy_from(pose);
        self.pass_on(0, out)
    }

    fn finish(&mut self, out: &mut Pose) -> bool {
        for index in 0..self.passes.len() {
            while self.passes[index].finish(&mut self.between[0]) {
                if self.pass_on(index + 1, out) {
                    return true;
                }
            }
        }
        false
    }
}

/// The latest frames of one pass.
struct Pass {
    /// Earlier and later frames of a window.
    back: usize,
    ahead: usize,
    squared: bool,
    /// Exponents of the weights in time, for each lag from 1 on.
    times: Vec<f64>,
    /// Factors of angles, or of their squares, per joint.
    factors: Vec<f64>,
    frames: Ring<PLANES>,
    /// Half rotation vectors from the filtered frame to another.
    reach: [Vec<f64>; 3],
    sums: [Vec<f64>; 3],
    total: Vec<f64>,
}

impl Pass {
    fn new(filter: &Bilateral) -> Self {
        let width = width(filter.sigma_angle.len());
        let (back, ahead) = (filter.radius, filter.radius.min(filter.lookahead.unwrap_or(usize::MAX)));
        let squared = filter.kernel != Kernel::Printed;
        let scale = if squared { 0.5 } else { 1.0 };
        let zeros = || vec![0.0; width];
        Self {
            back,
            ahead,
            squared,
            times: (1..=back).map(|lag| filter.exponent(lag).min(LARGEST_FACTOR)).collect(),
            factors: plane(
                filter.sigma_angle.iter().map(|sigma| (scale / sigma / sigma).min(LARGEST_FACTOR)),
            ),
            frames: Ring::new(back + ahead + 1, width),
            reach: [zeros(), zeros(), zeros()],
            sums: [zeros(), zeros(), zeros()],
            total: zeros(),
        }
    }

    /// Adds the weighted displacements to the frames on one side of the filtered frame.
    fn add_side(&mut self, later: bool) {
        let Self { frames, times, factors, reach, sums, total, squared, ahead, .. } = self;
        for plane in &mut *reach {
            plane.fill(0.0);
        }
        let now = *ahead;
        let [a, b, c, d, ..] = frames.ago(now);
        let lags = if later { *ahead } else { self.back };
        for (lag, &time) in (1..=lags).zip(&*times) {
            let there = frames.ago(if later { now - lag } else { now + lag });
            // The increment between the frames at `lag` and `lag − 1` is stored at the later of them.
            let steps = if later { there } else { frames.ago(now + lag - 1) };
            let [p, q, r, s, ..] = there;
            let [.., x, y, z] = steps;
            let sign = if later { 1.0 } else { -1.0 };
            let side = Side { sign, time, factors, squared: *squared };
            add_displacements(
                [a, b, c, d],
                [p, q, r, s],
                [x, y, z],
                &side,
                reach.each_mut().map(|plane| &mut plane[..]),
                sums.each_mut().map(|plane| &mut plane[..]),
                total,
            );
        }
    }
}

/// Weights of the frames of one lag.
struct Side<'a, T> {
    /// 1 for later frames, −1 for earlier ones.
    sign: T,
    /// The exponent of the weight in time.
    time: T,
    /// Factors of angles, or of their squares.
    factors: &'a [T],
    squared: bool,
}

impl Window for Pass {
    fn reach(&self) -> (usize, usize) {
        (self.back, self.ahead)
    }

    fn admit(&mut self, pose: &Pose) {
        let [a, b, c, d, ..] = self.frames.advance();
        for (plane, q) in [a, b, c, d].into_iter().zip(pose.rotations()) {
            plane.copy_from_slice(q);
        }
        if self.back > 0 {
            let [p, q, r, s, ..] = self.frames.ago(1);
            let [a, b, c] = self.reach.each_mut().map(|plane| &mut plane[..]);
            steps([p, q, r, s], pose.rotations(), [a, b, c]);
            let [.., x, y, z] = self.frames.newest_mut();
            for (plane, step) in [x, y, z].into_iter().zip(&self.reach) {
                plane.copy_from_slice(step);
            }
        }
    }

    fn settle(&mut self, out: &mut Pose) {
        self.total.fill(1.0);
        for plane in &mut self.sums {
            plane.fill(0.0);
        }
        self.add_side(true);
        self.add_side(false);
        let [a, b, c, d, ..] = self.frames.ago(self.ahead);
        let sums = self.sums.each_ref().map(|plane| &plane[..]);
        move_by([a, b, c, d], sums, &self.total, out.rotations_mut());
    }

    fn appear(&mut self, joint: usize, q: [f64; 4]) {
        let [w, x, y, z] = q;
        self.frames.fill(0, joint, [w, x, y, z, 0.0, 0.0, 0.0]);
    }
}

multiversion! {
    /// Half rotation vectors of the shorter rotation from `q` to `r`.
    fn steps<T: Real>(q: [&[T]; 4], r: [&[T]; 4], v: [&mut [T]; 3]) {
        let n = q[0].len();
        let (q, r) = (q.map(|q| &q[..n]), r.map(|r| &r[..n]));
        let [x, y, z] = v.map(|v| &mut v[..n]);
        for i in 0..n {
            let one = log_short(between([q[0][i], q[1][i], q[2][i], q[3][i]], [r[0][i], r[1][i], r[2][i], r[3][i]]));
            x[i] = one[0];
            y[i] = one[1];
            z[i] = one[2];
        }
    }
}

multiversion! {
    /// Extends the displacements from `q` by one increment, to `r`, and adds them with their weights.
    fn add_displacements<T: Real>(
        q: [&[T]; 4], r: [&[T]; 4], step: [&[T]; 3], side: &Side<'_, T>,
        reach: [&mut [T]; 3], sums: [&mut [T]; 3], total: &mut [T],
    ) {
        let n = total.len();
        let (q, r) = (q.map(|q| &q[..n]), r.map(|r| &r[..n]));
        let Side { sign, time, factors, squared } = *side;
        let (step, factors) = (step.map(|step| &step[..n]), &factors[..n]);
        let [a, b, c] = reach.map(|reach| &mut reach[..n]);
        let [x, y, z] = sums.map(|sums| &mut sums[..n]);
        for i in 0..n {
            let theta = angle_between([q[0][i], q[1][i], q[2][i], q[3][i]], [r[0][i], r[1][i], r[2][i], r[3][i]]);
            let distance = if squared { theta * theta } else { theta };
            let weight = (-(time + factors[i] * distance)).exp();
            a[i] += sign * step[0][i];
            b[i] += sign * step[1][i];
            c[i] += sign * step[2][i];
            total[i] += weight;
            x[i] += weight * a[i];
            y[i] += weight * b[i];
            z[i] += weight * c[i];
        }
    }
}

multiversion! {
    /// `q·exp(sums / total)`.
    fn move_by<T: Real>(q: [&[T]; 4], sums: [&[T]; 3], total: &[T], out: [&mut [T]; 4]) {
        let n = total.len();
        let (q, sums) = (q.map(|q| &q[..n]), sums.map(|sums| &sums[..n]));
        let [w, x, y, z] = out.map(|out| &mut out[..n]);
        for i in 0..n {
            let by = exp_one([sums[0][i] / total[i], sums[1][i] / total[i], sums[2][i] / total[i]]);
            let one = unit(product([q[0][i], q[1][i], q[2][i], q[3][i]], by));
            w[i] = one[0];
            x[i] = one[1];
            y[i] = one[2];
            z[i] = one[3];
        }
    }
}
