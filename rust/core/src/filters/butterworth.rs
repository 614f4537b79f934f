//! Recursive filters, forwards and backwards, on rotations about their reference path.
//!
//! Second-order sections in direct form II, transposed:
//!
//! ```text
//! y = b0 x + z0,     z0 ← b1 x − a1 y + z1,     z1 ← b2 x − a2 y
//! ```

use super::development::{Columns, Smooth};
use crate::Error;
use crate::clip::Planes;
use crate::error::check_length;
use crate::parallel::Interrupt;

/// Coefficients of a section: `b0 b1 b2 a0 a1 a2`, with `a0 = 1`.
const COEFFICIENTS: usize = 6;

/// The parameters of the filter.
#[derive(Debug, Clone)]
pub struct Butterworth {
    /// The sections of each joint, `(joints, sections, 6)`.
    pub sections: Vec<f64>,
    /// The steady states of the sections for a constant input of 1, `(joints, sections, 2)`.
    pub states: Vec<f64>,
    /// Number of sections of a joint.
    pub count: usize,
    /// Number of frames added at both ends, less than the number of frames: reflected about the end points.
    pub padding: usize,
}

impl Smooth for Butterworth {
    fn nanoseconds(&self) -> usize {
        10 * self.count
    }

    fn check(&self, _frames: usize, joints: usize) -> Result<(), Error> {
        check_length("sections", joints * self.count * COEFFICIENTS, self.sections.len())?;
        check_length("states", joints * self.count * 2, self.states.len())
    }

    fn smooth(
        &self,
        joint: usize,
        mut columns: Columns<'_>,
        spare: &mut Planes<f64>,
        interrupt: &Interrupt,
    ) -> Result<(), Error> {
        columns.pull();
        let Columns { frames, vectors, .. } = columns;
        let padding = self.padding.min(frames.saturating_sub(1));
        spare.reshape(3, frames + 2 * padding);
        let mut extended = spare.rows_mut::<3>(0);
        for (extended, vector) in extended.iter_mut().zip(&vectors) {
            extend(&vector[..frames], padding, extended);
        }
        let own = joint * self.count..(joint + 1) * self.count;
        let (sections, _) = self.sections.as_chunks::<COEFFICIENTS>();
        let (states, _) = self.states.as_chunks::<2>();
        for backwards in [false, true] {
            interrupt.check()?;
            let first = if backwards { frames + 2 * padding - 1 } else { 0 };
            let first = extended.each_ref().map(|column| column[first]);
            for (section, state) in sections[own.clone()].iter().zip(&states[own.clone()]) {
                let states = first.map(|x| state.map(|z| z * x));
                run(&mut extended, section, states, backwards);
            }
        }
        for (vector, extended) in vectors.into_iter().zip(extended) {
            vector[..frames].copy_from_slice(&extended[padding..padding + frames]);
        }
        Ok(())
    }
}

/// Writes a column with `padding` more values at both ends, `x_{−n} = 2 x_0 − x_n`.
fn extend(column: &[f64], padding: usize, out: &mut [f64]) {
    let last = column.len() - 1;
    for n in 1..=padding {
        out[padding - n] = 2.0 * column[0] - column[n];
        out[padding + last + n] = 2.0 * column[last] - column[last - n];
    }
    out[padding..=padding + last].copy_from_slice(column);
}

/// Runs a section along three columns, which are independent of each other.
fn run(
    columns: &mut [&mut [f64]; 3],
    &[b0, b1, b2, _, a1, a2]: &[f64; COEFFICIENTS],
    mut states: [[f64; 2]; 3],
    backwards: bool,
) {
    let [x, y, z] = columns;
    let n = x.len();
    let (y, z) = (&mut y[..n], &mut z[..n]);
    for k in 0..n {
        let i = if backwards { n - 1 - k } else { k };
        for (value, [z0, z1]) in [&mut x[i], &mut y[i], &mut z[i]].into_iter().zip(&mut states) {
            let input = *value;
            let output = b0 * input + *z0;
            *z0 = b1 * input - a1 * output + *z1;
            *z1 = b2 * input - a2 * output;
            *value = output;
        }
    }
}
