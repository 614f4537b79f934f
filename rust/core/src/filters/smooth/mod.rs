//! Automatic smoothing: how much, is read off the clip.
//!
//! Each joint is seen as vectors about its reference path, along the principal axes of its steps; each axis is smoothed by
//! penalised least squares, as strongly as the risk in blocks of the clip asks for. The second round takes the result of the
//! first as reference path.
//!
//! - `axes`: principal axes;
//! - `spectrum`, `strength`: how much to smooth;
//! - `penalised`: the smoother;
//! - `joint`: one joint along its axes;
//! - `about`: the vectors of all joints about a pilot;
//! - `body`: all joints together along the axes of the body;
//! - `patches`: all joints by groups of similar patches;
//! - `low_pass`: a fixed cut-off for all joints;
//! - `rank`: all joints as few movements at a time;
//! - `gains`: the learned last step;
//! - `steps`, `products`, `symmetric`: which joints move together, products of matrices, eigenvectors;
//! - `sums`: means of what overlapping pieces say.

mod about;
mod axes;
mod body;
mod gains;
mod joint;
mod low_pass;
mod patches;
mod penalised;
mod products;
mod rank;
mod spectrum;
mod steps;
mod strength;
mod sums;
mod symmetric;

use super::development::{Columns, Input, Smooth};
use crate::clip::Planes;
use crate::error::check_length;
use crate::parallel::Interrupt;
use crate::{ClipView, Error};
pub use about::Noisy;
pub use body::smooth_body;
pub use gains::{Network, smooth_gains};
pub use low_pass::LowPass;
pub use patches::smooth_patches;
pub use rank::smooth_rank;
use strength::Candidates;

/// Deviation in frames of the Gaussian mask that makes the first reference path, without noise; heavy noise asks for more.
pub const REFERENCE_SIGMA: f64 = 10.0;

/// Whatever is measured in less noise has squares that may be infinite; such noise counts as none.
const LEAST_NOISE: f64 = 1e-100;

/// How often the clip is smoothed about a reference path.
const ROUNDS: usize = 2;

/// The smoother, for clips of one length.
#[derive(Debug, Clone)]
pub struct Smoother {
    noise: Vec<f64>,
    translation_noise: f64,
    /// None where there is nothing to smooth.
    candidates: Option<Candidates>,
}

impl Smoother {
    /// For clips of so many frames.
    ///
    /// `noise` is the deviation of the noise per component of the rotation vector in radians, for each joint, and
    /// `translation_noise` that per coordinate of the translation; where it is 0 everything stays as it is.
    #[must_use]
    pub fn new(frames: usize, noise: Vec<f64>, translation_noise: f64) -> Self {
        let candidates = (frames > 1).then(|| Candidates::new(frames));
        Self { noise, translation_noise, candidates }
    }

    fn run(
        &self,
        noise: f64,
        mut columns: Columns<'_>,
        spare: &mut Planes<f64>,
        interrupt: &Interrupt,
    ) -> Result<(), Error> {
        match &self.candidates {
            Some(candidates) if noise >= LEAST_NOISE => {
                joint::smooth(&mut columns, noise, candidates, spare, interrupt)
            }
            _ => Ok(()),
        }
    }
}

/// The smoother of paths of one length, without rotations.
#[derive(Debug, Clone)]
pub(crate) struct PathSmoother(Smoother);

impl PathSmoother {
    /// For paths of so many frames.
    pub(crate) fn new(frames: usize) -> Self {
        Self(Smoother::new(frames, Vec::new(), 0.0))
    }

    /// Smooths a path `(frames, 3)` whose coordinates have noise of this deviation.
    pub(crate) fn smooth(
        &self,
        path: &[f64],
        noise: f64,
        out: &mut [f64],
        interrupt: &Interrupt,
    ) -> Result<(), Error> {
        let input = Input {
            clip: ClipView::new(&[], path.len() / 3, 0)?,
            confidence: None,
            reference_sigma: &[REFERENCE_SIGMA],
        };
        let smoother = Smoother { translation_noise: noise, ..self.0.clone() };
        input.translate(&smoother, path, out, interrupt)
    }
}

impl Smooth for Smoother {
    fn nanoseconds(&self) -> usize {
        400
    }

    fn carried(&self) -> bool {
        false
    }

    /// About a reference path that is chance, its rounds find a spin; and slower turns than a spin are fast beside its mask.
    fn follows_spins(&self) -> bool {
        false
    }

    fn check(&self, frames: usize, joints: usize) -> Result<(), Error> {
        if let Some(candidates) = &self.candidates {
            check_length("frames", candidates.frames(), frames)?;
        }
        check_length("noise", joints, self.noise.len())
    }

    fn noise(&self, joint: usize) -> f64 {
        self.noise[joint]
    }

    fn rounds(&self) -> usize {
        ROUNDS
    }

    fn smooth(
        &self,
        joint: usize,
        columns: Columns<'_>,
        spare: &mut Planes<f64>,
        interrupt: &Interrupt,
    ) -> Result<(), Error> {
        self.run(self.noise[joint], columns, spare, interrupt)
    }

    fn smooth_translation(
        &self,
        columns: Columns<'_>,
        spare: &mut Planes<f64>,
        interrupt: &Interrupt,
    ) -> Result<(), Error> {
        self.run(self.translation_noise, columns, spare, interrupt)
    }
}
