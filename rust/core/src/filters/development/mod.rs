//! Rotations as vectors about a reference path: what filters for numbers can be applied to.
//!
//! Of a noisy path `q_t` a smooth one `r_t` is made, an average in R⁴, and rolled out:
//!
//! ```text
//! R_0 = 0,     R_{t+1} = R_t + 2 log(r_t⁻¹ r_{t+1})       the development of the reference path
//! y_t = R_t + 2 log(r_t⁻¹ q_t)                            the vectors, radians of rotation
//! r_t exp((F(y)_t − R_t) / 2)                             what a filter F for numbers makes of them
//! ```
//!
//! All these vectors are seen from the frame of the body, or from one that is carried along the path by parallel transport, which
//! turns it half as far:
//!
//! ```text
//! h_0 = 1,     h_{t+1} = h_t (r_t⁻¹ r_{t+1})^½            and h ω h⁻¹ for each vector ω above
//! ```
//!
//! With `r = q` and `h = 1` this is Lee and Shin's construction; about a smooth path the commutators of the noise do not add up.
//!
//! Each joint is worked through over the whole clip, in float64; a task is a group of joints side by side in memory.

mod align;
mod joint;
mod rows;

use super::columns::{BLOCK, Mask};
pub use super::local::Translation;
use crate::clip::Planes;
use crate::error::check_length;
use crate::noise::coherence::coherence;
use crate::parallel::{self, Interrupt};
use crate::rotations::quaternion;
use crate::window::Boundary;
use crate::{ClipMut, ClipView, Error, Real};
use align::GROUP;
pub use joint::Columns;
pub(super) use joint::Joint;
pub use rows::undevelop;
pub(super) use rows::{interleave, store};
use std::ops::Range;
use std::sync::Mutex;

/// Estimated nanoseconds per frame and joint of the way to the vectors and back.
const NANOSECONDS: usize = 60;

/// Where noise leaves less of a mean, the reference path takes no more frames for it.
const LEAST_CLARITY: f64 = 1.0 / 16.0;

/// A filter for numbers, to be applied to rotations by [`Input::filter`].
pub trait Smooth: Sync {
    /// Estimated nanoseconds per frame and joint.
    fn nanoseconds(&self) -> usize;

    /// Refuses parameters that do not fit a clip of at least two frames.
    ///
    /// # Errors
    /// [`Error::Length`], [`Error::Parameter`].
    fn check(&self, _frames: usize, _joints: usize) -> Result<(), Error> {
        Ok(())
    }

    /// Deviation of the noise of a joint per component of the rotation vector in radians, where it is known: in heavy noise the
    /// reference path takes the mean of more frames.
    fn noise(&self, _joint: usize) -> f64 {
        0.0
    }

    /// Whether the vectors are seen from the frame that is carried along: then small rotations are filtered as their vectors, up
    /// to products of three angles. The axes of a body that turns are at rest in its own frame alone.
    fn carried(&self) -> bool {
        true
    }

    /// How often the rotations are filtered, each time about the result of the time before.
    fn rounds(&self) -> usize {
        1
    }

    /// Filters the vectors of a joint in place.
    ///
    /// # Errors
    /// [`Error::Interrupted`].
    fn smooth(
        &self,
        joint: usize,
        columns: Columns<'_>,
        spare: &mut Planes<f64>,
        interrupt: &Interrupt,
    ) -> Result<(), Error>;

    /// Filters a translation in place; as the first joint, unless it has parameters of its own.
    ///
    /// # Errors
    /// [`Error::Interrupted`].
    fn smooth_translation(
        &self,
        columns: Columns<'_>,
        spare: &mut Planes<f64>,
        interrupt: &Interrupt,
    ) -> Result<(), Error> {
        self.smooth(0, columns, spare, interrupt)
    }
}

/// What is filtered, and how its reference path is made.
#[derive(Debug, Clone, Copy)]
pub struct Input<'a, T> {
    /// Rotations without missing samples; they need not have length 1 exactly.
    pub clip: ClipView<'a, T>,
    /// Weights of the samples in the reference path, `(frames, joints)`, from 0 to 1.
    pub confidence: Option<&'a [T]>,
    /// Deviation in frames of the Gaussian mask that makes the reference path, for each joint.
    pub reference_sigma: &'a [f64],
}

/// What noise leaves of the squared length of a mean of rotations, at least [`LEAST_CLARITY`]: so many times as many frames make a
/// reference path that is as clear as without noise.
fn clarity(noise: f64) -> f64 {
    let length = coherence(noise);
    (length * length).max(LEAST_CLARITY)
}

/// Memory that goes from task to task: fresh pages cost as much as the arithmetic.
#[derive(Debug, Default)]
struct Buffers {
    samples: Planes<f64>,
    joint: Planes<f64>,
    spare: Planes<f64>,
}

impl<T: Real> Input<'_, T> {
    /// Refuses slices that do not fit together.
    pub(super) fn check(&self) -> Result<(), Error> {
        check_length("reference_sigma", self.clip.joints(), self.reference_sigma.len())?;
        let samples = self.clip.frames() * self.clip.joints();
        self.confidence.map_or(Ok(()), |trust| check_length("confidence", samples, trust.len()))
    }

    /// Develops each joint of a range, which has so much noise, in a frame that is `carried` along or in that of the body, and lets
    /// `work` write what it makes of it: `width` numbers for each frame. The results stand one joint after the other.
    pub(super) fn each_joint<W: Real>(
        &self,
        range: Range<usize>,
        noise: impl Fn(usize) -> f64,
        (width, carried): (usize, bool),
        nanoseconds: usize,
        interrupt: &Interrupt,
        work: impl Fn(usize, Joint<'_>, &mut Planes<f64>, &mut [W]) -> Result<(), Error> + Sync + Send,
    ) -> Result<Vec<W>, Error> {
        let frames = self.clip.frames();
        let clarity: Vec<f64> = (0..range.end).map(|joint| clarity(noise(joint))).collect();
        let masks: Vec<Mask> = self
            .reference_sigma
            .iter()
            .zip(&clarity)
            .map(|(sigma, clear)| Mask::gaussian(sigma / clear))
            .collect();
        let mut results = vec![W::ZERO; frames * range.len() * width];
        let groups: Vec<&mut [W]> = results.chunks_mut((frames * width * GROUP).max(1)).collect();
        let kept: Mutex<Vec<Buffers>> = Mutex::default();
        let work_of_all = frames * range.len() * (NANOSECONDS + nanoseconds);
        parallel::for_each(groups, work_of_all, |group, results| {
            let mut buffers = kept.lock().map_or(None, |mut kept| kept.pop()).unwrap_or_default();
            let Buffers { samples, joint, spare } = &mut buffers;
            let first = range.start + group * GROUP;
            align::load(self.clip, self.confidence, &clarity, first..range.end.min(first + GROUP), samples);
            for (i, results) in results.chunks_mut(frames * width).enumerate() {
                interrupt.check()?;
                let [w, x, y, z, trust] = samples.rows_mut(i * align::ROWS);
                let trust = self.confidence.map(|_| &*trust);
                let (how, memory) = ((&masks[first + i], carried), (&mut *joint, &mut *spare));
                let path = Joint::develop([w, x, y, z], trust, frames, how, memory, interrupt)?;
                work(first + i, path, spare, results)?;
            }
            if let Ok(mut kept) = kept.lock() {
                kept.push(buffers);
            }
            Ok(())
        })?;
        Ok(results)
    }

    /// Filters rotations into `out`, `(frames, joints, 4)`, sign-continuous from the hemisphere of the first frame, and the
    /// translation as it filters the first joint.
    ///
    /// # Errors
    /// [`Error::Length`] if slices do not fit together; [`Error::Interrupted`].
    pub fn filter(
        &self,
        filter: &impl Smooth,
        translation: Option<Translation<'_, T>>,
        out: ClipMut<'_, T>,
        interrupt: &Interrupt,
    ) -> Result<(), Error> {
        self.check()?;
        let (frames, joints) = (self.clip.frames(), self.clip.joints());
        let out = out.into_data();
        check_length("out", self.clip.data().len(), out.len())?;
        let short = frames < 2 || joints == 0;
        if !short {
            filter.check(frames, joints)?;
        }
        if let Some(Translation { values, out }) = translation {
            check_length("translation", frames * 3, values.len())?;
            check_length("translation out", frames * 3, out.len())?;
            if short {
                out.copy_from_slice(values);
            } else {
                self.translate(filter, values, out, interrupt)?;
            }
        }
        if short {
            return quaternion::normalize(self.clip.data(), out);
        }
        // A few joints at a time: their results need not all be there before they are in their places.
        let batch = parallel::num_threads() * GROUP;
        for first in (0..joints).step_by(batch) {
            let range = first..joints.min(first + batch);
            let results = self.each_joint(
                range.clone(),
                |joint| filter.noise(joint),
                (4, filter.carried()),
                filter.nanoseconds(),
                interrupt,
                |joint, mut path, spare, rows| {
                    for round in 0..filter.rounds() {
                        if round > 0 {
                            path.roll_out();
                        }
                        filter.smooth(joint, path.columns(), spare, interrupt)?;
                        path.follow_vectors();
                    }
                    store(&path, self.clip.at(0, joint), rows);
                    Ok(())
                },
            )?;
            interleave(&results, (4, 0..4), range, joints, out)?;
        }
        Ok(())
    }

    /// Filters a translation `(frames, 3)` with the parameters and the confidence of the first joint.
    pub(super) fn translate(
        &self,
        filter: &impl Smooth,
        values: &[T],
        out: &mut [T],
        interrupt: &Interrupt,
    ) -> Result<(), Error> {
        let frames = self.clip.frames();
        let mut spare = Planes::default();
        let mut planes = Planes::new(7, frames.next_multiple_of(BLOCK));
        let [x, y, z, trust, mean @ ..] = planes.rows_mut::<7>(0);
        let mut vectors = [x, y, z];
        let mut mean = mean;
        load_columns(values, &mut mean);
        let trust = self.confidence.map(|confidence| {
            for (value, from) in trust.iter_mut().zip(confidence.iter().step_by(self.clip.joints())) {
                *value = from.to_f64();
            }
            &*trust
        });
        let mask = Mask::gaussian(self.reference_sigma[0]);
        mask.means(&mut mean, trust, (frames, Boundary::Mirror), &mut spare, interrupt)?;
        for round in 0..filter.rounds() {
            if round > 0 {
                for (mean, vector) in mean.iter_mut().zip(&vectors) {
                    mean.copy_from_slice(vector);
                }
            }
            load_columns(values, &mut vectors);
            let columns = Columns {
                frames,
                vectors: vectors.each_mut().map(|column| &mut **column),
                mean: mean.each_ref().map(|column| &**column),
                trust,
            };
            filter.smooth_translation(columns, &mut spare, interrupt)?;
        }
        for (column, vector) in vectors.iter().enumerate() {
            for (value, from) in out[column..].iter_mut().step_by(3).zip(vector.iter()) {
                *value = T::from_f64(*from);
            }
        }
        Ok(())
    }
}

/// Reads rows of three numbers into columns.
fn load_columns<T: Real>(values: &[T], columns: &mut [&mut [f64]; 3]) {
    for (column, numbers) in columns.iter_mut().enumerate() {
        for (number, from) in numbers.iter_mut().zip(values[column..].iter().step_by(3)) {
            *number = from.to_f64();
        }
    }
}

/// A rolled-out clip, to be written.
#[derive(Debug)]
pub struct Developed<'a> {
    /// The path `r` of unit quaternions, `(frames, joints, 4)`.
    pub reference: &'a mut [f64],
    /// `R`, `(frames, joints, 3)`.
    pub development: &'a mut [f64],
    /// `y`, `(frames, joints, 3)`.
    pub vectors: &'a mut [f64],
}

/// Rolls rotations out about their reference path.
///
/// # Errors
/// [`Error::Length`] if slices do not fit together; [`Error::Interrupted`].
pub fn develop<T: Real>(
    input: Input<'_, T>,
    Developed { reference, development, vectors }: Developed<'_>,
    interrupt: &Interrupt,
) -> Result<(), Error> {
    /// Numbers of a frame of a joint: `r`, `R` and `y`.
    const WIDTH: usize = 4 + 3 + 3;
    input.check()?;
    let samples = input.clip.frames() * input.clip.joints();
    check_length("reference", samples * 4, reference.len())?;
    check_length("development", samples * 3, development.len())?;
    check_length("vectors", samples * 3, vectors.len())?;
    let joints = input.clip.joints();
    let results = input.each_joint(
        0..joints,
        |_| 0.0,
        (WIDTH, false),
        0,
        interrupt,
        |_, path, _, rows: &mut [f64]| {
            for (frame, row) in rows.chunks_exact_mut(WIDTH).enumerate() {
                let planes = path.reference.iter().chain(&path.development).chain(&path.vectors);
                for (value, plane) in row.iter_mut().zip(planes) {
                    *value = plane[frame];
                }
            }
            Ok(())
        },
    )?;
    interleave(&results, (WIDTH, 0..4), 0..joints, joints, reference)?;
    interleave(&results, (WIDTH, 4..7), 0..joints, joints, development)?;
    interleave(&results, (WIDTH, 7..10), 0..joints, joints, vectors)
}
