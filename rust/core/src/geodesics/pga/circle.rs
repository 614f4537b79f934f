//! Exact direction of the nearest geodesic among those in a plane.
//!
//! In a plane of directions, with `α` the angle of a sample's vector part `u` and `r = |u|`, the distance to the
//! geodesic with the direction `θ` is `arcsin(r |sin(θ − α)|)`. It is concave except for its kink at `α`. So is the
//! mean over the samples, which therefore has its minimum at the angle of a sample.
//!
//! The minimum is found by branch and bound. Between the angles `a` and `b`, the samples without a kink there have a
//! concave sum, which is at least the smaller of its values at `a` and `b`. The other samples add at least 0.

use super::descent::Found;
use super::objective::{Objective, scaled_to_one, value};
use super::samples::{LANES, Samples, dot};
use crate::parallel::{self, Interrupt};
use crate::simd::multiversion;
use crate::{Error, Real};

/// Number of parts of the circle, with equally many kinks, at the start of the search.
const PARTS: usize = 16;

/// Kinks per task.
const TASK: usize = 4096;

/// Estimated nanoseconds per kink of a sum.
const KINK_NANOSECONDS: usize = 8;

/// A sample in the plane: its angle in `[0, π)`, `w` and the two coordinates of `u`.
#[derive(Debug, Clone, Copy)]
struct Kink {
    angle: f64,
    w: f64,
    u: [f64; 2],
    sample: usize,
}

/// Kinks between two angles that are not yet excluded; the others are ordered before or after them.
#[derive(Debug, Clone, Copy)]
struct Part {
    start: usize,
    end: usize,
    /// The objective at the first kink and at the first kink after the end.
    ends: [f64; 2],
    bound: f64,
}

/// Search state: kinks, sorted as far as needed, and the best one so far.
struct Search<'a> {
    samples: &'a Samples,
    plane: [[f64; 3]; 2],
    kinks: Vec<Kink>,
    descent: Vec<f64>,
    best: [f64; 3],
    interrupt: &'a Interrupt,
}

/// Direction in the plane of two unit vectors with the lowest mean distance; the samples' vector parts lie in that
/// plane.
pub(super) fn nearest_in_plane(
    samples: &Samples,
    plane: [[f64; 3]; 2],
    interrupt: &Interrupt,
) -> Result<Found, Error> {
    let kinks = kinks(samples, plane, interrupt)?;
    let n = kinks.len();
    if n == 0 {
        return Ok(Found { direction: plane[0], descent: Vec::new() });
    }
    let mut search = Search { samples, plane, kinks, descent: Vec::new(), best: plane[0], interrupt };
    let mut borders: Vec<usize> = (0..PARTS).map(|part| part * n / PARTS).collect();
    borders.dedup();
    for (i, &border) in borders.iter().enumerate() {
        let from = if i > 0 { borders[i - 1] + 1 } else { 0 };
        search.sort_out(from, border, n);
    }
    let mut values = Vec::with_capacity(borders.len());
    for &border in &borders {
        values.push(search.objective_at(border)?);
    }
    let mut open = Vec::new();
    for (i, &start) in borders.iter().enumerate() {
        let next = (i + 1) % borders.len();
        let end = if next == 0 { n } else { borders[next] };
        search.divide(start, end, [values[i], values[next]], &mut open)?;
    }
    while let Some(lowest) = (0..open.len()).min_by(|&i, &j| open[i].bound.total_cmp(&open[j].bound)) {
        let part = open.swap_remove(lowest);
        if part.bound >= search.lowest() {
            break;
        }
        let middle = usize::midpoint(part.start, part.end);
        search.sort_out(part.start + 1, middle, part.end);
        let here = search.objective_at(middle)?;
        search.divide(part.start, middle, [part.ends[0], here], &mut open)?;
        search.divide(middle, part.end, [here, part.ends[1]], &mut open)?;
    }
    Ok(Found { direction: search.best, descent: search.descent })
}

/// The samples with a direction, in the plane.
fn kinks(samples: &Samples, plane: [[f64; 3]; 2], interrupt: &Interrupt) -> Result<Vec<Kink>, Error> {
    let parts = samples.map(10, interrupt, |part, start| {
        let [w, x, y, z] = part;
        let mut kinks = Vec::with_capacity(w.len());
        for i in 0..w.len() {
            let u = plane.map(|axis| dot([x[i], y[i], z[i]], axis));
            if (u[0] != 0.0) | (u[1] != 0.0) {
                // The angle of the line through `u`: that of `u` or `−u`.
                let (up, right) = if u[1] < 0.0 { (-u[1], -u[0]) } else { (u[1], u[0]) };
                let angle = Real::atan2_nonnegative(up, right);
                let angle = if angle < std::f64::consts::PI { angle } else { 0.0 };
                kinks.push(Kink { angle, w: w[i], u, sample: start + i });
            }
        }
        kinks
    })?;
    Ok(parts.concat())
}

impl Search<'_> {
    fn lowest(&self) -> f64 {
        self.descent.last().copied().unwrap_or(f64::INFINITY)
    }

    /// Partitions the kinks `from..to` so that the one at index `at` is in sorted order, with smaller ones before it
    /// and larger ones after it.
    fn sort_out(&mut self, from: usize, at: usize, to: usize) {
        self.kinks[from..to].select_nth_unstable_by(at - from, |a, b| {
            a.angle.total_cmp(&b.angle).then(a.sample.cmp(&b.sample))
        });
    }

    /// Direction of a kink, in the plane.
    fn line(&self, kink: usize) -> [f64; 2] {
        let u = self.kinks[kink % self.kinks.len()].u;
        let length = (u[0] * u[0] + u[1] * u[1]).sqrt();
        u.map(|x| x / length)
    }

    /// The objective at the direction of a kink, recorded if it is the best so far.
    fn objective_at(&mut self, kink: usize) -> Result<f64, Error> {
        let line = self.line(kink);
        let [a, b] = self.plane;
        let direction = scaled_to_one(std::array::from_fn(|i| line[0] * a[i] + line[1] * b[i]));
        let here = value(self.samples, direction, Objective::Geodesic, self.interrupt)?;
        if here < self.lowest() {
            self.descent.push(here);
            self.best = direction;
        }
        Ok(here)
    }

    /// Adds the part between two kinks to the open ones if it may contain a lower value.
    fn divide(&self, start: usize, end: usize, ends: [f64; 2], open: &mut Vec<Part>) -> Result<(), Error> {
        if end - start < 2 {
            return Ok(());
        }
        let inside: Vec<&[Kink]> = self.kinks[start + 1..end].chunks(TASK).collect();
        let lines = [self.line(start), self.line(end)];
        let parts = parallel::map(inside, (end - start) * KINK_NANOSECONDS, |_, kinks| {
            self.interrupt.check()?;
            let mut lanes = [[0.0; LANES]; 2];
            add_distances(kinks, lines, &mut lanes);
            Ok(lanes.map(|lanes| lanes.iter().sum::<f64>()))
        })?;
        let sums = parts.iter().fold([0.0; 2], |total, part| [total[0] + part[0], total[1] + part[1]]);
        let count = self.samples.count() as f64;
        let bound = (ends[0] - sums[0] / count).min(ends[1] - sums[1] / count);
        if bound < self.lowest() {
            open.push(Part { start, end, ends, bound });
        }
        Ok(())
    }
}

multiversion! {
    /// Sums of the distances from kinks to the geodesics with two directions in the plane.
    fn add_distances(kinks: &[Kink], lines: [[f64; 2]; 2], sums: &mut [[f64; LANES]; 2]) {
        let total = sums;
        let mut sums = *total;
        for chunk in kinks.chunks(LANES) {
            let (mut w, mut x, mut y) = ([1.0; LANES], [0.0; LANES], [0.0; LANES]);
            for (c, kink) in chunk.iter().enumerate() {
                (w[c], x[c], y[c]) = (kink.w, kink.u[0], kink.u[1]);
            }
            for (sums, line) in sums.iter_mut().zip(lines) {
                for c in 0..LANES {
                    let sine = (x[c] * line[1] - y[c] * line[0]).abs();
                    let p = x[c] * line[0] + y[c] * line[1];
                    sums[c] += sine.atan2_nonnegative((w[c] * w[c] + p * p).sqrt());
                }
            }
        }
        *total = sums;
    }
}
