//! A low pass for motion whose noise is temporally correlated: third differences are penalised.
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
        // Three columns, and one of zeros to fill the lanes.
        let padded = columns.vectors[0].len();
        spare.reshape(1, (3 + LANES * (1 + HIGHEST)) * padded);
        let (variances, memory) = spare.row_mut(0).split_at_mut(padded);
        let (softness, memory) = memory.split_at_mut(padded);
        let (zeros, rows) = memory.split_at_mut(padded);
        let (rows, _) = rows.as_chunks_mut::<LANES>();
        let (rows, _): (&mut [Row], _) = rows.as_chunks_mut::<{ 1 + HIGHEST }>();
        let variances = columns.trust.map(|trust| {
            inverses(trust, LEAST_WEIGHT, variances);
            &variances[..frames]
        });
        softness.fill(self.softness);
        zeros.fill(0.0);
        let [x, y, z] = columns.vectors;
        penalised(
            [ORDER; LANES],
            [x, y, z, zeros].map(|column| &mut column[..frames]),
            variances,
            [&softness[..frames]; LANES],
            rows,
            interrupt,
        )
    }
}
