//! Control points of the last frames, and the fit of database poses to them.

use super::poses::Poses;
use super::trajectories::LANES;
use crate::reconstruction::frame::HORIZONTAL;
use crate::simd::multiversion;

/// A control point of one frame: weight, horizontal position and height.
#[derive(Debug, Clone, Copy)]
struct Observation {
    /// Lag and index of the control point: its row in the trajectories, relative to the candidate.
    lag: usize,
    point: usize,
    /// Its index among the control points of a candidate.
    slot: usize,
    share: f64,
    level: [f64; 2],
    height: f64,
}

/// Rigid fit of a database pose to the control points: rotation about the up axis and horizontal shift.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fit {
    /// Real and imaginary part of `Σ w z̄_i c_i`, whose argument is the rotation angle.
    product: [f64; 2],
    mean: [f64; 2],
}

multiversion! {
    /// Weighted mean squared distances after the best fit; `planes` are as in
    /// [`Trajectories`](super::trajectories::Trajectories).
    fn distances(planes: &[f32], seen: &[Observation], spread: f64, out: &mut [f64]) {
        let groups = out.len().div_ceil(LANES).max(1);
        for (planes, out) in planes.chunks_exact((planes.len() / groups).max(1)).zip(out.chunks_mut(LANES)) {
            let (planes, _) = planes.as_chunks::<LANES>();
            let (mut mean, mut product) = ([[0.0; LANES]; 2], [[0.0; LANES]; 2]);
            let (mut square, mut height) = ([0.0; LANES], [0.0; LANES]);
            let mut origin = [[0.0; LANES]; 2];
            for (i, seen) in seen.iter().enumerate() {
                let (x, y, up) = (&planes[3 * seen.slot], &planes[3 * seen.slot + 1], &planes[3 * seen.slot + 2]);
                if i == 0 {
                    for lane in 0..LANES {
                        origin[0][lane] = f64::from(x[lane]);
                        origin[1][lane] = f64::from(y[lane]);
                    }
                }
                for lane in 0..LANES {
                    let z = [f64::from(x[lane]) - origin[0][lane], f64::from(y[lane]) - origin[1][lane]];
                    let above = f64::from(up[lane]) - seen.height;
                    mean[0][lane] += seen.share * z[0];
                    mean[1][lane] += seen.share * z[1];
                    square[lane] += seen.share * (z[0] * z[0] + z[1] * z[1]);
                    product[0][lane] += seen.share * (z[0] * seen.level[0] + z[1] * seen.level[1]);
                    product[1][lane] += seen.share * (z[0] * seen.level[1] - z[1] * seen.level[0]);
                    height[lane] += seen.share * (above * above);
                }
            }
            let mut left = [0.0; LANES];
            for lane in 0..LANES {
                let own = square[lane] - (mean[0][lane] * mean[0][lane] + mean[1][lane] * mean[1][lane]);
                let length = (product[0][lane] * product[0][lane] + product[1][lane] * product[1][lane]).sqrt();
                let level = own + spread - 2.0 * length;
                left[lane] = if level > 0.0 { level } else { 0.0 } + height[lane];
            }
            for (out, left) in out.iter_mut().zip(left) {
                *out = left;
            }
        }
    }
}

/// Control points of the current frame and of some previous ones.
#[derive(Debug, Clone, Default)]
pub(super) struct Observations {
    seen: Vec<Observation>,
    /// Weighted mean of the horizontal coordinates.
    mean: [f64; 2],
    /// Weighted mean of their squared distances from it.
    spread: f64,
}

impl Observations {
    /// Removes all observations.
    pub(super) fn clear(&mut self) {
        self.seen.clear();
    }

    /// Adds the points `(points, 3)` of a frame with their weights. `(slot, lag)` are the index of the frame in the
    /// window and its lag in frames.
    pub(super) fn add(&mut self, (slot, lag): (usize, usize), positions: &[f64], weights: &[f64], up: usize) {
        let [first, second] = HORIZONTAL[up];
        for (point, (at, &share)) in positions.chunks_exact(3).zip(weights).enumerate() {
            if share > 0.0 {
                let level = [at[first], at[second]];
                let slot = slot * weights.len() + point;
                self.seen.push(Observation { lag, point, slot, share, level, height: at[up] });
            }
        }
    }

    /// Normalises the weights to sum 1, and subtracts the weighted mean.
    pub(super) fn finish(&mut self) {
        let total: f64 = self.seen.iter().map(|seen| seen.share).sum();
        self.mean = [0.0; 2];
        for seen in &mut self.seen {
            seen.share /= total;
            self.mean[0] += seen.share * seen.level[0];
            self.mean[1] += seen.share * seen.level[1];
        }
        self.spread = 0.0;
        for seen in &mut self.seen {
            seen.level[0] -= self.mean[0];
            seen.level[1] -= self.mean[1];
            self.spread += seen.share * (seen.level[0] * seen.level[0] + seen.level[1] * seen.level[1]);
        }
    }

    /// Number of observed control points.
    pub(super) fn count(&self) -> usize {
        self.seen.len()
    }

    /// Squared distances after the best fit, of candidates side by side.
    pub(super) fn distances(&self, planes: &[f32], out: &mut [f64]) {
        distances(planes, &self.seen, self.spread, out);
    }

    /// Fits a pose to the points by a rotation about the up axis and a horizontal shift.
    pub(super) fn fit(&self, poses: &Poses<'_>, points: usize, candidate: usize, up: usize) -> Fit {
        let [first, second] = HORIZONTAL[up];
        let (mut mean, mut product) = ([0.0; 2], [0.0; 2]);
        // Relative to the first point: coordinates of a clip may be large.
        let mut origin = [0.0; 2];
        for (i, seen) in self.seen.iter().enumerate() {
            let row = 3 * ((candidate - seen.lag) * points + seen.point);
            let at = &poses.trajectories[row..row + 3];
            let z = [f64::from(at[first]), f64::from(at[second])];
            if i == 0 {
                origin = z;
            }
            let z = [z[0] - origin[0], z[1] - origin[1]];
            mean = [mean[0] + seen.share * z[0], mean[1] + seen.share * z[1]];
            product[0] += seen.share * (z[0] * seen.level[0] + z[1] * seen.level[1]);
            product[1] += seen.share * (z[0] * seen.level[1] - z[1] * seen.level[0]);
        }
        Fit { product, mean: [mean[0] + origin[0], mean[1] + origin[1]] }
    }

    /// Rotation angle of a fit, and the shift after the rotation.
    pub(super) fn transform(&self, fit: &Fit) -> (f64, [f64; 2]) {
        let [c, s] = fit.direction();
        let angle = crate::Real::atan2_nonnegative(s.abs(), c).copysign(s);
        let moved = [c * fit.mean[0] - s * fit.mean[1], s * fit.mean[0] + c * fit.mean[1]];
        (angle, [self.mean[0] - moved[0], self.mean[1] - moved[1]])
    }

    /// Whether the root-mean-square horizontal distance of the points from their mean exceeds `scale`. Otherwise they
    /// do not determine a heading.
    pub(super) fn determines_heading(&self, scale: f64) -> bool {
        self.spread > scale * scale
    }

    /// Residuals of a fitted pose at the points: two horizontal coordinates and the height, with the weight.
    pub(super) fn residuals<'a>(
        &'a self,
        poses: &'a Poses<'_>,
        points: usize,
        (candidate, fit): (usize, &'a Fit),
        up: usize,
    ) -> impl Iterator<Item = ([f64; 3], f64)> + 'a {
        let [first, second] = HORIZONTAL[up];
        let [c, s] = fit.direction();
        self.seen.iter().map(move |seen| {
            let row = 3 * ((candidate - seen.lag) * points + seen.point);
            let at = &poses.trajectories[row..row + 3];
            let z = [f64::from(at[first]) - fit.mean[0], f64::from(at[second]) - fit.mean[1]];
            let x = c * z[0] - s * z[1] - seen.level[0];
            let y = s * z[0] + c * z[1] - seen.level[1];
            ([x, y, f64::from(at[up]) - seen.height], seen.share)
        })
    }

    /// Position on the ground after the fit.
    pub(super) fn moved(&self, fit: &Fit, place: [f64; 2]) -> [f64; 2] {
        let [c, s] = fit.direction();
        let z = [place[0] - fit.mean[0], place[1] - fit.mean[1]];
        [c * z[0] - s * z[1] + self.mean[0], s * z[0] + c * z[1] + self.mean[1]]
    }
}

impl Fit {
    /// Cosine and sine of the rotation angle.
    fn direction(&self) -> [f64; 2] {
        let [re, im] = self.product;
        let length = (re * re + im * im).sqrt();
        if length > 0.0 { [re / length, im / length] } else { [1.0, 0.0] }
    }
}
