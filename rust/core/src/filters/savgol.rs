//! The Savitzky–Golay filter: polynomials fitted to windows, on rotations about their reference path.

use super::columns::{extend, slide};
use super::development::{Columns, Input, Smooth, interleave};
use crate::clip::Planes;
use crate::error::check_length;
use crate::parallel::Interrupt;
use crate::window::Boundary;
use crate::{Error, Real};

/// The parameters of the filter.
#[derive(Debug, Clone)]
pub struct Savgol {
    /// Window length in frames, odd.
    pub window: usize,
    /// Matrix from the values in the window to the coefficients of the polynomial, `(terms, window)`.
    pub fit: Vec<f64>,
    /// Matrix from the coefficients to the values of the polynomial at the frames of the window, `(window, terms)`.
    pub values: Vec<f64>,
}

impl Savgol {
    fn terms(&self) -> usize {
        self.fit.len() / self.window
    }

    /// Time derivative of rotations in body coordinates: `(frames, joints, 3)`.
    ///
    /// The rotations are smoothed and developed again about the result. Polynomials are fitted to the new vectors;
    /// the matrix `derivatives`, `(window, terms)`, maps their coefficients to derivatives at the frames of the
    /// window.
    ///
    /// # Errors
    /// [`Error::Length`] if the lengths of slices do not agree; [`Error::Parameter`] if the window is longer than the
    /// clip; [`Error::Interrupted`].
    pub fn derivative<T: Real>(
        &self,
        input: Input<'_, T>,
        derivatives: Vec<f64>,
        out: &mut [T],
        interrupt: &Interrupt,
    ) -> Result<(), Error> {
        let (frames, joints) = (input.clip.frames(), input.clip.joints());
        input.check()?;
        self.check(frames, joints)?;
        check_length("derivatives", self.values.len(), derivatives.len())?;
        check_length("out", frames * joints * 3, out.len())?;
        let derivative = Self { values: derivatives, ..self.clone() };
        let results = input.each_joint(
            0..joints,
            |_| 0.0,
            (3, true, true),
            2 * self.nanoseconds(),
            interrupt,
            |joint, mut path, spare, rows| {
                self.smooth(joint, path.columns(), spare, interrupt)?;
                path.follow_vectors();
                path.roll_out();
                derivative.smooth(joint, path.columns(), spare, interrupt)?;
                for (frame, row) in rows.chunks_exact_mut(3).enumerate() {
                    let vector = path.vectors.each_ref().map(|column| column[frame]);
                    for (value, number) in row.iter_mut().zip(path.of_body(frame, vector)) {
                        *value = T::from_f64(number);
                    }
                }
                Ok(())
            },
        )?;
        interleave(&results, (3, 0..3), 0..joints, joints, out)
    }

    /// Evaluates the polynomial fitted to the values `x` of a window, at its frames from `first` on.
    fn evaluate(&self, x: &[f64], first: usize, out: &mut [f64]) {
        out.fill(0.0);
        for (term, weights) in self.fit.chunks_exact(self.window).enumerate() {
            let coefficient: f64 = weights.iter().zip(x).map(|(weight, x)| weight * x).sum();
            for (out, values) in out.iter_mut().zip(self.values.chunks_exact(self.terms()).skip(first)) {
                *out += values[term] * coefficient;
            }
        }
    }
}

impl Smooth for Savgol {
    fn nanoseconds(&self) -> usize {
        5 + self.window / 2
    }

    fn check(&self, frames: usize, _joints: usize) -> Result<(), Error> {
        if self.window.is_multiple_of(2) || self.window > frames {
            return Err(Error::Parameter {
                name: "window",
                expected: "an odd number, at most that of frames",
            });
        }
        check_length("fit", self.terms() * self.window, self.fit.len())?;
        check_length("values", self.fit.len(), self.values.len())
    }

    fn smooth(
        &self,
        _joint: usize,
        mut columns: Columns<'_>,
        spare: &mut Planes<f64>,
        interrupt: &Interrupt,
    ) -> Result<(), Error> {
        columns.pull();
        let Columns { frames, vectors, .. } = columns;
        let radius = self.window / 2;
        let mut mask = vec![0.0; self.window];
        let middle = &self.values[radius * self.terms()..][..self.terms()];
        for (value, weights) in middle.iter().zip(self.fit.chunks_exact(self.window)) {
            for (mask, weight) in mask.iter_mut().zip(weights) {
                *mask += value * weight;
            }
        }
        for vector in vectors {
            spare.reshape(1, vector.len() + 2 * radius);
            let around = spare.row_mut(0);
            extend(&vector[..frames], radius, Boundary::Nearest, false, around);
            slide(&mask, around, vector, interrupt)?;
            let own = &around[radius..radius + frames];
            self.evaluate(&own[..self.window], 0, &mut vector[..radius]);
            self.evaluate(&own[frames - self.window..], radius + 1, &mut vector[frames - radius..frames]);
        }
        Ok(())
    }
}
