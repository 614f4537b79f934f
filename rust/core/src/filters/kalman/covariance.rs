//! Covariances of a pose and its velocity, and the gains that follow from them.
//!
//! The errors of the three coordinates are independent and identically distributed, so a covariance is a 2 × 2 matrix
//! times the identity, and a gain is a scalar. Time is counted in frames. From one frame to the next
//!
//! ```text
//! F = [[1, 1], [0, 1]]     Q = q [[1/3, 1/2], [1/2, 1]]
//! ```
//!
//! with the variance `q` that white acceleration adds to the velocity within a frame. The determinant is stored too:
//! as a difference of large products it would be lost to rounding while the velocity is hardly known.

/// Covariance of the errors of pose and velocity.
#[derive(Debug, Clone, Copy, Default)]
pub(in crate::filters) struct Covariance {
    pub(super) pose: f64,
    pub(super) cross: f64,
    pub(super) velocity: f64,
    pub(super) determinant: f64,
}

impl Covariance {
    /// After one measurement of the pose: only the prior variance of the velocity is known.
    #[inline(always)]
    pub(super) fn first(pose: f64, velocity: f64) -> Self {
        Self { pose, cross: 0.0, velocity, determinant: pose * velocity }
    }

    #[inline(always)]
    pub(super) fn of_array([pose, cross, velocity, determinant]: [f64; 4]) -> Self {
        Self { pose, cross, velocity, determinant }
    }

    #[inline(always)]
    pub(super) fn to_array(self) -> [f64; 4] {
        [self.pose, self.cross, self.velocity, self.determinant]
    }

    /// One frame later: `F P Fᵀ + Q`.
    #[inline(always)]
    pub(super) fn predicted(self, q: f64) -> Self {
        let Self { pose, cross, velocity, determinant } = self;
        Self {
            pose: pose + 2.0 * cross + velocity + q / 3.0,
            cross: cross + velocity + q / 2.0,
            velocity: velocity + q,
            determinant: determinant + q * (pose + cross + velocity / 3.0) + q * q / 12.0,
        }
    }

    /// Gains of a measurement of the pose with the variance `variance / confidence`: the corrections of pose and
    /// velocity per unit of innovation.
    #[inline(always)]
    pub(super) fn gains(self, variance: f64, confidence: f64) -> [f64; 2] {
        let total = confidence * self.pose + variance;
        [confidence * self.pose / total, confidence * self.cross / total]
    }

    /// Covariance after a measurement of the pose; confidence 0 changes nothing.
    #[inline(always)]
    pub(super) fn updated(self, variance: f64, confidence: f64) -> Self {
        let total = confidence * self.pose + variance;
        Self {
            pose: self.pose * variance / total,
            cross: self.cross * variance / total,
            velocity: (confidence * self.determinant + self.velocity * variance) / total,
            determinant: self.determinant * variance / total,
        }
    }

    /// The smoother gain `C = P Fᵀ (F P Fᵀ + Q)⁻¹`, row by row.
    #[inline(always)]
    pub(super) fn smoother_gains(self, q: f64) -> [f64; 4] {
        let Self { pose, cross, velocity, determinant } = self;
        let after = self.predicted(q).determinant;
        [
            (determinant + q * (pose + cross / 2.0)) / after,
            -(determinant + q * (pose / 2.0 + cross / 6.0)) / after,
            q * (cross + velocity / 2.0) / after,
            (determinant - q * (cross / 2.0 + velocity / 6.0)) / after,
        ]
    }

    /// `P + C (Pₛ − F P Fᵀ − Q) Cᵀ` for the smoothed covariance `Pₛ` one frame later, as pose, cross and velocity.
    #[inline(always)]
    pub(super) fn smoothed(self, after: [f64; 3], q: f64) -> [f64; 3] {
        let [c11, c12, c21, c22] = self.smoother_gains(q);
        let before = self.predicted(q);
        let (pose, cross, velocity) =
            (after[0] - before.pose, after[1] - before.cross, after[2] - before.velocity);
        [
            self.pose + c11 * c11 * pose + 2.0 * c11 * c12 * cross + c12 * c12 * velocity,
            self.cross + c11 * c21 * pose + (c11 * c22 + c12 * c21) * cross + c12 * c22 * velocity,
            self.velocity + c21 * c21 * pose + 2.0 * c21 * c22 * cross + c22 * c22 * velocity,
        ]
    }
}
