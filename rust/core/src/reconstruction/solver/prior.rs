//! Gaussian prior of the coordinates of a pose.

use super::dense;
use crate::Error;
use crate::error::check_length;

/// A Gaussian with the covariance `diag(deviation²) + axes·axesᵀ`.
#[derive(Debug, Clone, Copy)]
pub struct Prior<'a> {
    /// Means, `(coordinates)`.
    pub mean: &'a [f64],
    /// Standard deviations apart from the axes, above 0, `(coordinates)`.
    pub deviation: &'a [f64],
    /// Additional directions of variation, each as long as one standard deviation, `(coordinates, n)`; or none.
    pub axes: &'a [f64],
}

impl Prior<'_> {
    /// Number of axes.
    pub(super) fn count(&self) -> usize {
        if self.mean.is_empty() { 0 } else { self.axes.len() / self.mean.len() }
    }

    /// The row of the axes of one coordinate.
    pub(super) fn axes_of(&self, coordinate: usize) -> &[f64] {
        let count = self.count();
        &self.axes[coordinate * count..(coordinate + 1) * count]
    }

    pub(super) fn check(&self, coordinates: usize) -> Result<(), Error> {
        check_length("mean", coordinates, self.mean.len())?;
        check_length("deviation", coordinates, self.deviation.len())?;
        check_length("axes", coordinates * self.count(), self.axes.len())?;
        if self.deviation.iter().all(|&deviation| deviation > 0.0) {
            return Ok(());
        }
        Err(Error::Parameter { name: "deviation", expected: "numbers above 0" })
    }

    /// `C⁻¹ (x − μ)` by the Woodbury identity.
    pub(super) fn force(&self, x: &[f64]) -> Vec<f64> {
        let plain = |d: usize| (x[d] - self.mean[d]) / (self.deviation[d] * self.deviation[d]);
        let mut force: Vec<f64> = (0..x.len()).map(plain).collect();
        let n = self.count();
        if n == 0 || force.iter().all(|&value| value == 0.0) {
            return force;
        }
        let mut inner = vec![0.0; n * n];
        let mut along = vec![0.0; n];
        for (d, &force) in force.iter().enumerate() {
            let (row, share) = (self.axes_of(d), 1.0 / (self.deviation[d] * self.deviation[d]));
            for i in 0..n {
                along[i] += row[i] * force;
                for j in 0..=i {
                    inner[i * n + j] += row[i] * row[j] * share;
                }
            }
        }
        for i in 0..n {
            inner[i * n + i] += 1.0;
        }
        if dense::factor(&mut inner, n) {
            dense::solve(&inner, n, &mut along);
            for (d, force) in force.iter_mut().enumerate() {
                *force -= dense::dot(self.axes_of(d), &along) / (self.deviation[d] * self.deviation[d]);
            }
        }
        force
    }
}
