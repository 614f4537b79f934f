//! A low pass for motion whose noise hangs together in time: third differences are penalised.
//!
//! The gain is `1/(1 + r⁶)`, `r = sin(π f/fps) / sin(π f_c/fps)`; parabolas stay as they are.

use super::joint::{LEAST_WEIGHT, inverses};
use super::penalised::{HIGHEST, Memory, penalised};
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
        spare.reshape(4 + HIGHEST, frames);
        let [variances, softness, solution, pivots, lower @ ..] = spare.rows_mut::<{ 4 + HIGHEST }>(0);
        variances.fill(1.0);
        if let Some(trust) = columns.trust {
            inverses(trust, LEAST_WEIGHT, variances);
        }
        softness.fill(self.softness);
        let softness = &softness[..frames - ORDER];
        let mut memory = Memory { solution, pivots, lower };
        for vector in columns.vectors {
            penalised(ORDER, &mut vector[..frames], variances, softness, &mut memory, interrupt)?;
        }
        Ok(())
    }
}
