//! The rotations of one joint relative to their centre: planes that every pass reads.

use crate::clip::Planes;
use crate::parallel::{self, Interrupt};
use crate::rotations::quaternion::{between, is_missing, unit};
use crate::simd::multiversion;
use crate::{ClipView, Error, Real};
use std::ops::Range;

/// Number of running sums: two vectors of float64 at AVX2, one at AVX-512.
pub(super) const LANES: usize = 8;

/// Samples per task: their planes fit in the second-level cache.
const TASK: usize = 8192;

/// Samples on S³ with `w ≥ 0`, as planes `w`, `x`, `y`, `z`, padded with ones to whole lanes.
#[derive(Debug)]
pub(super) struct Samples {
    planes: Planes<f64>,
    count: usize,
}

/// A range of the four planes, in whole lanes.
pub(super) type Quad<'a> = [&'a [f64]; 4];

impl Samples {
    pub(super) fn filled(count: usize, at: impl Fn(usize) -> [f64; 4]) -> Self {
        let mut planes = Planes::new(4, count.next_multiple_of(LANES));
        let [w, x, y, z] = planes.rows_mut::<4>(0);
        for i in 0..count {
            [w[i], x[i], y[i], z[i]] = at(i);
        }
        w[count..].fill(1.0);
        Self { planes, count }
    }

    /// The valid samples of a joint, `mean⁻¹ q` in the half of S³ about 1.
    pub(super) fn of_joint<T: Real>(clip: ClipView<'_, T>, joint: usize, mean: [f64; 4]) -> Self {
        let centre = unit(mean);
        let seen: Vec<[f64; 4]> = (0..clip.frames())
            .map(|frame| clip.at(frame, joint))
            .filter(|q| !is_missing(*q))
            .map(|q| q.map(T::to_f64))
            .collect();
        Self::filled(seen.len(), |i| upper(between(centre, unit(seen[i]))))
    }

    /// At most about `most` of the samples, evenly spaced.
    pub(super) fn subset(&self, most: usize) -> Self {
        let stride = self.count.div_ceil(most).max(1);
        Self::filled(self.count.div_ceil(stride), |i| self.at(i * stride))
    }

    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// Number of padding ones.
    pub(super) fn filling(&self) -> usize {
        self.planes.length() - self.count
    }

    pub(super) fn at(&self, i: usize) -> [f64; 4] {
        std::array::from_fn(|row| self.planes.row(row)[i])
    }

    /// All four planes.
    pub(super) fn all(&self) -> Quad<'_> {
        self.planes.rows_from(0)
    }

    /// Runs `work` on ranges of the samples that begin at multiples of [`LANES`], and returns its results in order.
    pub(super) fn map<R: Send>(
        &self,
        nanoseconds: usize,
        interrupt: &Interrupt,
        work: impl Fn(Quad<'_>, usize) -> R + Sync + Send,
    ) -> Result<Vec<R>, Error> {
        let length = self.planes.length();
        let tasks: Vec<Range<usize>> =
            (0..length).step_by(TASK).map(|start| start..(start + TASK).min(length)).collect();
        parallel::map(tasks, length * nanoseconds, |_, range| {
            interrupt.check()?;
            Ok(work(self.all().map(|plane| &plane[range.clone()]), range.start))
        })
    }

    /// Sums `N` rows of lanes to which `work` adds.
    pub(super) fn sums<const N: usize>(
        &self,
        nanoseconds: usize,
        interrupt: &Interrupt,
        work: impl Fn(Quad<'_>, &mut [[f64; LANES]; N]) + Sync + Send,
    ) -> Result<[f64; N], Error> {
        let parts = self.map(nanoseconds, interrupt, |samples, _| {
            let mut sums = [[0.0; LANES]; N];
            work(samples, &mut sums);
            sums.map(|lanes| lanes.iter().sum::<f64>())
        })?;
        Ok(parts.iter().fold([0.0; N], |total, part| std::array::from_fn(|i| total[i] + part[i])))
    }

    /// Replaces each sample by its residual from the geodesic with the direction `v`.
    pub(super) fn take_away(&mut self, v: [f64; 3], interrupt: &Interrupt) -> Result<(), Error> {
        let length = self.planes.length();
        let mut rest = self.planes.rows_mut::<4>(0);
        let mut tasks: Vec<[&mut [f64]; 4]> = Vec::new();
        for start in (0..length).step_by(TASK) {
            let end = (start + TASK).min(length) - start;
            tasks.push(rest.each_mut().map(|plane| {
                let (part, tail) = std::mem::take(plane).split_at_mut(end);
                *plane = tail;
                part
            }));
        }
        parallel::for_each(tasks, length * 5, |_, mut part| {
            interrupt.check()?;
            take_away(&mut part, v);
            Ok(())
        })
    }

    /// Mean rotation angle of the samples; NaN without any.
    pub(super) fn mean_angle(&self, interrupt: &Interrupt) -> Result<f64, Error> {
        let [sum] = self.sums(3, interrupt, add_angles)?;
        Ok(2.0 * sum / self.count as f64)
    }

    /// Largest rotation angle of the samples; 0 without any.
    pub(super) fn greatest_angle(&self, interrupt: &Interrupt) -> Result<f64, Error> {
        let parts = self.map(3, interrupt, |samples, _| {
            let mut most = [[0.0; LANES]; 1];
            most_angle(samples, &mut most);
            most[0].iter().fold(0.0, |a, &b| f64::max(a, b))
        })?;
        Ok(2.0 * parts.into_iter().fold(0.0, f64::max))
    }
}

/// `q` or `−q`, whichever has `w ≥ 0`.
#[inline(always)]
pub(super) fn upper(q: [f64; 4]) -> [f64; 4] {
    q.map(|x| x * 1.0_f64.copysign(q[0]))
}

/// The residual of a sample from the geodesic with the direction `v`, `c_v(s*)⁻¹ x`.
#[inline(always)]
pub(super) fn left_of([w, x, y, z]: [f64; 4], v: [f64; 3]) -> [f64; 4] {
    let p = x * v[0] + y * v[1] + z * v[2];
    let f = (w * w + p * p).sqrt();
    let inverse = if f > 0.0 { 1.0 / f } else { 1.0 };
    let across = [x - p * v[0], y - p * v[1], z - p * v[2]];
    let turned = cross(v, across);
    unit([
        f,
        (w * across[0] - p * turned[0]) * inverse,
        (w * across[1] - p * turned[1]) * inverse,
        (w * across[2] - p * turned[2]) * inverse,
    ])
}

/// Cross product.
#[inline(always)]
pub(super) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Inner product.
#[inline(always)]
pub(super) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

multiversion! {
    fn take_away(samples: &mut [&mut [f64]; 4], v: [f64; 3]) {
        let [w, x, y, z] = samples;
        for (((w, x), y), z) in w.iter_mut().zip(x.iter_mut()).zip(y.iter_mut()).zip(z.iter_mut()) {
            [*w, *x, *y, *z] = left_of([*w, *x, *y, *z], v);
        }
    }
}

multiversion! {
    fn add_angles(samples: Quad<'_>, sums: &mut [[f64; LANES]; 1]) {
        let total = sums;
        let mut sums = *total;
        let [w, x, y, z] = samples.map(|plane| plane.as_chunks::<LANES>().0);
        for (((w, x), y), z) in w.iter().zip(x).zip(y).zip(z) {
            for c in 0..LANES {
                sums[0][c] += (x[c] * x[c] + y[c] * y[c] + z[c] * z[c]).sqrt().atan2_nonnegative(w[c]);
            }
        }
        *total = sums;
    }
}

multiversion! {
    fn most_angle(samples: Quad<'_>, most: &mut [[f64; LANES]; 1]) {
        let [w, x, y, z] = samples.map(|plane| plane.as_chunks::<LANES>().0);
        for (((w, x), y), z) in w.iter().zip(x).zip(y).zip(z) {
            for c in 0..LANES {
                let angle = (x[c] * x[c] + y[c] * y[c] + z[c] * z[c]).sqrt().atan2_nonnegative(w[c]);
                most[0][c] = if angle > most[0][c] { angle } else { most[0][c] };
            }
        }
    }
}
