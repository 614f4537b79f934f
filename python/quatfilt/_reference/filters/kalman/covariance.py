"""Covariances of a pose and its velocity, and the gains that follow from them.

The errors of the three coordinates are independent and alike, so that a covariance is a matrix of two rows times the
identity, and a gain is a number. Time is counted in frames. From one frame to the next

    F = [[1, 1], [0, 1]],     Q = q [[1/3, 1/2], [1/2, 1]],

with the variance `q` that white acceleration adds to the velocity within a frame. The determinant is carried along: as
a difference of large products it would be lost to rounding while the velocity is hardly known.
"""

from typing import NamedTuple

import numpy as np

from quatfilt._reference._arrays import Reals


class Covariance(NamedTuple):
    """Covariance of the errors of pose and velocity, one for each joint; arrays of one shape."""

    pose: Reals
    cross: Reals
    velocity: Reals
    determinant: Reals

    def predicted(self, q: Reals) -> "Covariance":
        """One frame later: `F P Fᵀ + Q`."""
        return Covariance(
            self.pose + 2 * self.cross + self.velocity + q / 3,
            self.cross + self.velocity + q / 2,
            self.velocity + q,
            self.determinant + q * (self.pose + self.cross + self.velocity / 3) + q * q / 12,
        )

    def gains(self, variance: Reals, trust: Reals) -> tuple[Reals, Reals]:
        """Return by which shares of the innovation a measurement of the pose of variance `variance / trust` corrects both."""
        total = trust * self.pose + variance
        return trust * self.pose / total, trust * self.cross / total

    def updated(self, variance: Reals, trust: Reals) -> "Covariance":
        """After a measurement of the pose; without trust nothing changes."""
        total = trust * self.pose + variance
        return Covariance(
            self.pose * variance / total,
            self.cross * variance / total,
            (trust * self.determinant + self.velocity * variance) / total,
            self.determinant * variance / total,
        )

    def smoother_gains(self, q: Reals) -> tuple[Reals, Reals, Reals, Reals]:
        """Return the matrix `C = P Fᵀ (F P Fᵀ + Q)⁻¹` row by row: what one frame learns from the next."""
        after = self.predicted(q).determinant
        return (
            (self.determinant + q * (self.pose + self.cross / 2)) / after,
            -(self.determinant + q * (self.pose / 2 + self.cross / 6)) / after,
            q * (self.cross + self.velocity / 2) / after,
            (self.determinant - q * (self.cross / 2 + self.velocity / 6)) / after,
        )

    def smoothed(self, after: Reals, q: Reals) -> Reals:
        """`P + C (Pₛ − F P Fᵀ − Q) Cᵀ` for the smoothed covariance `Pₛ` one frame later; `(3, joints)`, both."""
        c11, c12, c21, c22 = self.smoother_gains(q)
        pose, cross, velocity = after - np.stack(self.predicted(q)[:3])
        return np.stack(
            [
                self.pose + c11 * c11 * pose + 2 * c11 * c12 * cross + c12 * c12 * velocity,
                self.cross + c11 * c21 * pose + (c11 * c22 + c12 * c21) * cross + c12 * c22 * velocity,
                self.velocity + c21 * c21 * pose + 2 * c21 * c22 * cross + c22 * c22 * velocity,
            ]
        )
