//! A low pass for motion whose noise hangs together in time: third differences are penalised.
//!
//! The gain is `1/(1 + r⁶)`, `r = sin(π f/fps) / sin(π f_c/fps)`; parabolas stay as they are.

use super::joint::{LEAST_WEIGHT, inverses};
use super::penalised::{HIGHEST, LANES, Row, penalised};
use crate::Error;
use crate::clip::Planes;
use crate::filters::development::{Columns, Smooth};
use crate::parallel::Interrupt;

/// Order of the differences.
const ORDER: usize = 3;

/// How often the clip is filtered about a reference path; the second is the result of the first.
const ROUNDS: usize = 2;

/// The filter.
#[derive(Debug, Clone, Copy)]
pub struct LowPass {
    /// `(2 sin(π f_c / fps))⁶` for the cut-off `f_c`.
    pub softness: f64,
}

impl Smooth for LowPass {
    fn nanoseconds(&self) -> usize {
        200
    }

    fn rounds(&self) -> usize {
        ROUNDS
    }

    fn smooth(
        &self,
        _joint: usize,
        columns: Columns<'_>,
        spare: &mut Planes<f64>,
        interrupt: &Interrupt,
    ) -> Result<(), Error> {
        let frames = columns.frames;
        if frames <= ORDER {
            return Ok(());
        }
        spare.reshape(1, (3 + LANES * (1 + HIGHEST)) * frames);
        let (variances, rest) = spare.row_mut(0).split_at_mut(frames);
        let (softness, rest) = rest.split_at_mut(frames);
        // The vectors have three columns, and four are solved side by side.
        let (fourth, rest) = rest.split_at_mut(frames);
        let (rows, _) = rest.as_chunks_mut::<LANES>();
        let (rows, _): (&mut [Row], _) = rows.as_chunks_mut::<{ 1 + HIGHEST }>();
        if let Some(trust) = columns.trust {
            inverses(trust, LEAST_WEIGHT, variances);
        }
        softness.fill(self.softness);
        fourth.fill(0.0);
        let [x, y, z] = columns.vectors.map(|vector| &mut vector[..frames]);
        let variances = columns.trust.map(|_| &*variances);
        penalised([ORDER; LANES], [x, y, z, fourth], variances, [&*softness; LANES], rows, interrupt)?;
        Ok(())
    }
}
