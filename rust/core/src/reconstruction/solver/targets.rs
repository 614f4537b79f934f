//! Observed control points, and the errors of a pose relative to them.

use crate::Error;
use crate::error::check_length;
use crate::reconstruction::kinematics::{
    Base, Body, Points, matrix, right_jacobian_inverse, times, transposed,
};
use crate::rotations::quaternion::{between, log_short, of_row};

/// Observed control points.
#[derive(Debug, Clone, Copy)]
pub struct Targets<'a> {
    /// Positions, `(points, 3)`.
    pub positions: &'a [f64],
    /// Standard deviation of each coordinate, `(points)`; infinite where a point is not observed.
    pub position_deviations: &'a [f64],
    /// Global rotations, `(points, 4)`.
    pub orientations: &'a [f64],
    /// Standard deviation of each component of the rotation vector, radians, `(points)`; infinite where not observed.
    pub orientation_deviations: &'a [f64],
}

impl Targets<'_> {
    pub(in crate::reconstruction) fn check(&self, points: usize) -> Result<(), Error> {
        check_length("positions", 3 * points, self.positions.len())?;
        check_length("position_deviations", points, self.position_deviations.len())?;
        check_length("orientations", 4 * points, self.orientations.len())?;
        check_length("orientation_deviations", points, self.orientation_deviations.len())
    }

    /// Number of errors.
    pub(super) fn count(&self) -> usize {
        let seen = |deviations: &[f64]| deviations.iter().filter(|deviation| deviation.is_finite()).count();
        3 * (seen(self.position_deviations) + seen(self.orientation_deviations))
    }
}

/// Errors of a pose in standard deviations, and their Jacobian.
#[derive(Debug, Clone)]
pub(super) struct Errors {
    points: Points,
    pub(super) values: Vec<f64>,
    /// `(errors, columns)`.
    pub(super) rows: Vec<f64>,
}

impl Errors {
    pub(super) fn new(body: &Body) -> Self {
        Self { points: Points::new(body), values: Vec::new(), rows: Vec::new() }
    }

    pub(super) fn columns(&self) -> usize {
        self.points.columns()
    }

    /// Half the sum of squares.
    pub(super) fn energy(&self) -> f64 {
        0.5 * self.values.iter().map(|value| value * value).sum::<f64>()
    }

    /// Computes the errors of the pose with the coordinates `x`, and their Jacobian.
    pub(super) fn at(&mut self, body: &Body, base: &Base, targets: &Targets<'_>, x: &[f64]) {
        let columns = self.points.columns();
        self.values.clear();
        self.rows.resize(targets.count() * columns, 0.0);
        self.points.place(body, base, x);
        let mut blocks = self.rows.chunks_exact_mut(3 * columns);
        for point in seen(targets.position_deviations) {
            let Some(block) = blocks.next() else { return };
            let deviation = targets.position_deviations[point];
            let (place, _) = self.points.at(body, point);
            self.points.position_rows(body, base, point, block);
            for (&is, &should) in place.iter().zip(&targets.positions[3 * point..]) {
                self.values.push((is - should) / deviation);
            }
            for value in block.iter_mut() {
                *value /= deviation;
            }
        }
        for point in seen(targets.orientation_deviations) {
            let Some(block) = blocks.next() else { return };
            let deviation = targets.orientation_deviations[point];
            let (_, turn) = self.points.at(body, point);
            self.points.rotation_rows(body, point, block);
            let vector =
                log_short(between(of_row(&targets.orientations[4 * point..]), turn)).map(|v| 2.0 * v);
            let inward = times(&right_jacobian_inverse(vector), &transposed(&matrix(turn)));
            self.values.extend(vector.map(|v| v / deviation));
            for column in 0..columns {
                let spin = [block[column], block[columns + column], block[2 * columns + column]];
                for (i, row) in inward.iter().enumerate() {
                    let sum = row[0] * spin[0] + row[1] * spin[1] + row[2] * spin[2];
                    block[i * columns + column] = sum / deviation;
                }
            }
        }
    }
}

/// Indices of the observed points.
fn seen(deviations: &[f64]) -> impl Iterator<Item = usize> {
    deviations.iter().enumerate().filter(|(_, deviation)| deviation.is_finite()).map(|(point, _)| point)
}
