//! Control points of the last frames, and how poses of the database fit them.

use super::poses::Poses;
use super::trajectories::LANES;
use crate::reconstruction::frame::HORIZONTAL;
use crate::simd::multiversion;

/// A control point of one frame, as a weighted point of the plane with a height.
#[derive(Debug, Clone, Copy)]
struct Observation {
    /// Where its row of the trajectories lies before that of the candidate, and in it.
    lag: usize,
    point: usize,
    /// Which it is of a candidate's control points side by side.
    slot: usize,
    share: f64,
    level: [f64; 2],
    height: f64,
}

/// How a pose of the database lies on the control points.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fit {
    /// Real and imaginary part of `Σ w z̄_i c_i`, whose angle is the turn.
    product: [f64; 2],
    mean: [f64; 2],
}

multiversion! {
    /// Weighted means of the squared distances that are left; `planes` are as in [`Trajectories`](super::trajectories::Trajectories).
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

/// Control points of the frame in question and of some before.
#[derive(Debug, Clone, Default)]
pub(super) struct Observations {
    seen: Vec<Observation>,
    /// Weighted mean of the level coordinates.
    mean: [f64; 2],
    /// Weighted mean of their squared distances from it.
    spread: f64,
}

impl Observations {
    /// Starts anew.
    pub(super) fn clear(&mut self) {
        self.seen.clear();
    }

    /// Takes in the points `(points, 3)` of a frame with their weights; `(slot, lag)` are which frame of the window it is, and
    /// how many frames ago.
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

    /// Turns weights into shares, and takes the mean away.
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

    /// How many control points are compared.
    pub(super) fn count(&self) -> usize {
        self.seen.len()
    }

    /// The distances that [`fit`](Self::fit) leaves, of candidates side by side.
    pub(super) fn distances(&self, planes: &[f32], out: &mut [f64]) {
        distances(planes, &self.seen, self.spread, out);
    }

    /// Lays a pose on the points: turned about the up axis, and moved on the ground.
    pub(super) fn fit(&self, poses: &Poses<'_>, points: usize, candidate: usize, up: usize) -> Fit {
        let [first, second] = HORIZONTAL[up];
        let (mut mean, mut product) = ([0.0; 2], [0.0; 2]);
        // From the first point: coordinates of a clip may be large.
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

    /// By how much a pose is turned, and moved after the turn.
    pub(super) fn transform(&self, fit: &Fit) -> (f64, [f64; 2]) {
        let [c, s] = fit.direction();
        let angle = crate::Real::atan2_nonnegative(s.abs(), c).copysign(s);
        let moved = [c * fit.mean[0] - s * fit.mean[1], s * fit.mean[0] + c * fit.mean[1]];
        (angle, [self.mean[0] - moved[0], self.mean[1] - moved[1]])
    }

    /// Whether the points lie farther than `scale` from their middle as seen from above, root mean square: nearer ones do not tell
    /// a heading.
    pub(super) fn determines_heading(&self, scale: f64) -> bool {
        self.spread > scale * scale
    }

    /// What is left between the points and a pose that is laid on them: two level coordinates and the height of each, and its share.
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

    /// Where a place on the ground comes when a pose is laid on the points.
    pub(super) fn moved(&self, fit: &Fit, place: [f64; 2]) -> [f64; 2] {
        let [c, s] = fit.direction();
        let z = [place[0] - fit.mean[0], place[1] - fit.mean[1]];
        [c * z[0] - s * z[1] + self.mean[0], s * z[0] + c * z[1] + self.mean[1]]
    }
}

impl Fit {
    /// Cosine and sine of the turn.
    fn direction(&self) -> [f64; 2] {
        let [re, im] = self.product;
        let length = (re * re + im * im).sqrt();
        if length > 0.0 { [re / length, im / length] } else { [1.0, 0.0] }
    }
}
