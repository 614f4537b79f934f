//! What moves, and how far it is from one place to another.

use crate::Real;
use crate::rotations::quaternion::{between, exp_one, log_short, product};

/// By how much the first and cheap test may err.
pub(super) const SLACK: f64 = 1e-9;

/// What moves: a rotation or a position.
pub(super) trait Place: Copy + PartialEq + Send + Sync {
    /// The way from `self` to `to`: a rotation vector in radians, or a difference.
    fn step(self, to: Self) -> [f64; 3];

    /// What lies one step from `self`.
    fn moved(self, step: [f64; 3]) -> Self;

    /// A number that grows with the distance, and costs less.
    fn nearness(self, to: Self) -> f64;

    /// The same number for a distance.
    fn nearness_at(distance: f64) -> f64;

    fn distance(self, to: Self) -> f64 {
        length(self.step(to))
    }
}

/// A unit quaternion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rotation(pub(super) [f64; 4]);

impl Place for Rotation {
    fn step(self, to: Self) -> [f64; 3] {
        log_short(between(self.0, to.0)).map(|x| 2.0 * x)
    }

    fn moved(self, step: [f64; 3]) -> Self {
        Self(product(self.0, exp_one(step.map(|x| x / 2.0))))
    }

    fn nearness(self, to: Self) -> f64 {
        let [_, x, y, z] = between(self.0, to.0);
        x * x + y * y + z * z
    }

    fn nearness_at(distance: f64) -> f64 {
        if distance < std::f64::consts::PI {
            let (sine, _) = Real::sin_cos(distance / 2.0);
            sine * sine
        } else {
            f64::INFINITY
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Position(pub(super) [f64; 3]);

impl Place for Position {
    fn step(self, to: Self) -> [f64; 3] {
        std::array::from_fn(|c| to.0[c] - self.0[c])
    }

    fn moved(self, step: [f64; 3]) -> Self {
        Self(std::array::from_fn(|c| self.0[c] + step[c]))
    }

    fn nearness(self, to: Self) -> f64 {
        let [x, y, z] = self.step(to);
        x * x + y * y + z * z
    }

    fn nearness_at(distance: f64) -> f64 {
        distance * distance
    }
}

fn length([x, y, z]: [f64; 3]) -> f64 {
    (x * x + y * y + z * z).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cheap_measure_grows_with_the_distance() {
        let turned = |angle: f64| Rotation(exp_one([0.0, angle / 2.0, 0.0]));
        for angle in [1e-9, 0.1, 1.0, 3.0] {
            let measured = turned(0.0).nearness(turned(angle));
            assert!((measured / Rotation::nearness_at(angle) - 1.0).abs() < SLACK, "{angle}");
        }
        assert_eq!(Rotation::nearness_at(4.0), f64::INFINITY);
    }
}
