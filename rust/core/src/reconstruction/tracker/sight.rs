//! Control points of the last frames, and how poses of the database fit them.

use super::poses::Poses;
use crate::reconstruction::frame::HORIZONTAL;

/// A control point of one frame, as a weighted point of the plane with a height.
#[derive(Debug, Clone, Copy)]
struct Seen {
    /// Where its row of the trails lies before that of the candidate, and in it.
    lag: usize,
    point: usize,
    share: f64,
    level: [f64; 2],
    height: f64,
}

/// How a pose of the database lies on the control points.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fit {
    /// Weighted mean of the squared distances that are left; 0 where nothing is seen.
    pub(super) distance: f64,
    /// Real and imaginary part of `Σ w z̄_i c_i`, whose angle is the turn.
    product: [f64; 2],
    mean: [f64; 2],
}

/// Control points of the frame in question and of some before.
#[derive(Debug, Clone, Default)]
pub(super) struct Sight {
    seen: Vec<Seen>,
    /// Weighted mean of the level coordinates.
    mean: [f64; 2],
    /// Weighted mean of their squared distances from it.
    spread: f64,
}

impl Sight {
    /// Starts anew.
    pub(super) fn clear(&mut self) {
        self.seen.clear();
    }

    /// Takes in the points `(points, 3)` of a frame with their weights.
    pub(super) fn add(&mut self, lag: usize, positions: &[f64], weights: &[f64], up: usize) {
        let [first, second] = HORIZONTAL[up];
        for (point, (at, &share)) in positions.chunks_exact(3).zip(weights).enumerate() {
            if share > 0.0 {
                let level = [at[first], at[second]];
                self.seen.push(Seen { lag, point, share, level, height: at[up] });
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

    /// Lays a pose on the points: turned about the up axis, and moved on the ground.
    #[inline(always)]
    pub(super) fn fit(&self, poses: &Poses<'_>, points: usize, candidate: usize, up: usize) -> Fit {
        let [first, second] = HORIZONTAL[up];
        let (mut mean, mut square, mut product, mut height) = ([0.0; 2], 0.0, [0.0; 2], 0.0);
        // From the first point: coordinates of a clip may be large.
        let mut origin = [0.0; 2];
        for (i, seen) in self.seen.iter().enumerate() {
            let row = 3 * ((candidate - seen.lag) * points + seen.point);
            let at = &poses.trails[row..row + 3];
            let z = [f64::from(at[first]), f64::from(at[second])];
            if i == 0 {
                origin = z;
            }
            let z = [z[0] - origin[0], z[1] - origin[1]];
            let above = f64::from(at[up]) - seen.height;
            mean = [mean[0] + seen.share * z[0], mean[1] + seen.share * z[1]];
            square += seen.share * (z[0] * z[0] + z[1] * z[1]);
            product[0] += seen.share * (z[0] * seen.level[0] + z[1] * seen.level[1]);
            product[1] += seen.share * (z[0] * seen.level[1] - z[1] * seen.level[0]);
            height += seen.share * (above * above);
        }
        let own = square - (mean[0] * mean[0] + mean[1] * mean[1]);
        let length = (product[0] * product[0] + product[1] * product[1]).sqrt();
        let level = own + self.spread - 2.0 * length;
        let mean = [mean[0] + origin[0], mean[1] + origin[1]];
        Fit { distance: level.max(0.0) + height, product, mean }
    }

    /// By how much a pose is turned, and moved after the turn.
    pub(super) fn laid(&self, fit: &Fit) -> (f64, [f64; 2]) {
        let [re, im] = fit.product;
        let length = (re * re + im * im).sqrt();
        let (c, s) = if length > 0.0 { (re / length, im / length) } else { (1.0, 0.0) };
        let angle = crate::Real::atan2_nonnegative(s.abs(), c).copysign(s);
        let moved = [c * fit.mean[0] - s * fit.mean[1], s * fit.mean[0] + c * fit.mean[1]];
        (angle, [self.mean[0] - moved[0], self.mean[1] - moved[1]])
    }
}
