//! The Gaussian filter: a mask of Gaussian weights, on rotations about their reference path. Confidence multiplies
//! the weights.

use super::columns::Mask;
use super::development::{Columns, Smooth};
use crate::clip::Planes;
use crate::error::check_length;
use crate::parallel::Interrupt;
use crate::window::Boundary;
use crate::{Error, Real};

/// The parameters of the filter.
#[derive(Debug, Clone)]
pub struct Gaussian {
    /// Standard deviation of the mask in frames, for each joint.
    pub sigma: Vec<f64>,
    /// Continuation of the vectors beyond the ends of the clip.
    pub boundary: Boundary,
}

impl Smooth for Gaussian {
    fn nanoseconds(&self) -> usize {
        let widest = self.sigma.iter().fold(0.0, |widest: f64, &sigma| widest.max(sigma));
        5 + (2.0 * widest).to_count()
    }

    fn check(&self, _frames: usize, joints: usize) -> Result<(), Error> {
        check_length("sigma", joints, self.sigma.len())
    }

    fn smooth(
        &self,
        joint: usize,
        columns: Columns<'_>,
        spare: &mut Planes<f64>,
        interrupt: &Interrupt,
    ) -> Result<(), Error> {
        let Columns { frames, mut vectors, trust, .. } = columns;
        let mask = Mask::gaussian(self.sigma[joint]);
        mask.means(&mut vectors, trust, (frames, self.boundary), spare, interrupt)
    }
}
