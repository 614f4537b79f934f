//! Rotations as vectors about a reference path, to which linear filters can be applied.
//!
//! The noisy path `q_t` is averaged in R⁴ to a smooth reference path `r_t`, which is developed:
//!
//! ```text
//! R_0 = 0,     R_{t+1} = R_t + 2 log(r_t⁻¹ r_{t+1})       the development of the reference path
//! y_t = R_t + 2 log(r_t⁻¹ q_t)                            the vectors, radians of rotation
//! r_t exp((F(y)_t − R_t) / 2)                             the result of a linear filter F
//! ```
//!
//! All these vectors are in body coordinates, or in a frame that is moved along the path by parallel transport, which
//! rotates it by half of each rotation:
//!
//! ```text
//! h_0 = 1,     h_{t+1} = h_t (r_t⁻¹ r_{t+1})^½            and h ω h⁻¹ for each vector ω above
//! ```
//!
//! With `r = q` and `h = 1` this is Lee and Shin's construction; about a smooth path the commutators of the noise do
//! not accumulate.
//!
//! Each joint is processed over the whole clip, in float64; a task is a group of joints side by side in memory.

mod align;
mod joint;
mod rows;
mod spin;

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
use joint::Chart;
pub use joint::Columns;
pub(super) use joint::Joint;
pub use rows::undevelop;
pub(super) use rows::{interleave, store};
use std::ops::Range;
use std::sync::Mutex;

/// Estimated nanoseconds per frame and joint for the development and its inverse.
const NANOSECONDS: usize = 60;

/// Smallest clarity for which the reference path uses more frames.
const LEAST_CLARITY: f64 = 1.0 / 16.0;

/// A linear filter, applied to rotations by [`Input::filter`].
pub trait Smooth: Sync {
    /// Estimated nanoseconds per frame and joint.
    fn nanoseconds(&self) -> usize;

    /// Checks that the parameters agree with a clip of at least two frames.
    ///
    /// # Errors
    /// [`Error::Length`], [`Error::Parameter`].
    fn check(&self, _frames: usize, _joints: usize) -> Result<(), Error> {
        Ok(())
    }

    /// Standard deviation of a joint's noise per component of the rotation vector in radians, if known: in heavy
    /// noise the reference path averages more frames.
    fn noise(&self, _joint: usize) -> f64 {
        0.0
    }

    /// Whether the vectors are relative to the frame moved by parallel transport. Then small rotations are filtered
    /// as their vectors, up to products of three angles. Only in body coordinates are the axes of a rotating body
    /// constant.
    fn carried(&self) -> bool {
        true
    }

    /// Whether spinning joints are slowed down before their reference path is computed.
    fn follows_spins(&self) -> bool {
        true
    }

    /// Number of times that the rotations are filtered, each time about the previous result.
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

    /// Filters a translation in place; like the first joint, unless the filter has parameters for it.
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

/// Input of a linear filter, and parameters of its reference path.
#[derive(Debug, Clone, Copy)]
pub struct Input<'a, T> {
    /// Rotations without missing samples; they need not have length 1 exactly.
    pub clip: ClipView<'a, T>,
    /// Weights of the samples in the reference path, `(frames, joints)`, from 0 to 1.
    pub confidence: Option<&'a [T]>,
    /// Standard deviation in frames of the Gaussian mask of the reference path, for each joint.
    pub reference_sigma: &'a [f64],
}

/// Factor by which noise reduces the squared length of a mean of rotations, at least [`LEAST_CLARITY`]. Its inverse
/// is the factor by which the number of averaged frames must grow to compensate.
fn clarity(noise: f64) -> f64 {
    let length = coherence(noise);
    (length * length).max(LEAST_CLARITY)
}

/// Scratch memory, reused from task to task: fresh pages cost as much as the arithmetic.
#[derive(Debug, Default)]
struct Buffers {
    samples: Planes<f64>,
    joint: Planes<f64>,
    spare: Planes<f64>,
}

impl<T: Real> Input<'_, T> {
    /// Checks that the lengths of slices agree.
    pub(super) fn check(&self) -> Result<(), Error> {
        check_length("reference_sigma", self.clip.joints(), self.reference_sigma.len())?;
        let samples = self.clip.frames() * self.clip.joints();
        self.confidence.map_or(Ok(()), |trust| check_length("confidence", samples, trust.len()))
    }

    /// Develops each joint of a range, with the given noise; `carried` selects the transported frame or the body
    /// frame, and `spins` whether spinning joints are slowed down. `work` writes `width` values per frame. The
    /// results are stored joint by joint.
    pub(super) fn each_joint<W: Real>(
        &self,
        range: Range<usize>,
        noise: impl Fn(usize) -> f64,
        (width, carried, spins): (usize, bool, bool),
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
                let spins = spins.then_some(self.reference_sigma[first + i]);
                let (chart, memory) =
                    (Chart { mask: &masks[first + i], spins, carried }, (&mut *joint, &mut *spare));
                let path = Joint::develop([w, x, y, z], trust, frames, chart, memory, interrupt)?;
                work(first + i, path, spare, results)?;
            }
            if let Ok(mut kept) = kept.lock() {
                kept.push(buffers);
            }
            Ok(())
        })?;
        Ok(results)
    }

    /// Filters rotations into `out`, `(frames, joints, 4)`, sign-continuous from the hemisphere of the first frame,
    /// and the translation like the first joint.
    ///
    /// # Errors
    /// [`Error::Length`] if the lengths of slices do not agree; [`Error::Interrupted`].
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
        // A few joints at a time, to limit the memory of the intermediate results.
        let batch = parallel::num_threads() * GROUP;
        for first in (0..joints).step_by(batch) {
            let range = first..joints.min(first + batch);
            let results = self.each_joint(
                range.clone(),
                |joint| filter.noise(joint),
                (4, filter.carried(), filter.follows_spins()),
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

/// Reads rows of three values into columns.
fn load_columns<T: Real>(values: &[T], columns: &mut [&mut [f64]; 3]) {
    for (column, numbers) in columns.iter_mut().enumerate() {
        for (number, from) in numbers.iter_mut().zip(values[column..].iter().step_by(3)) {
            *number = from.to_f64();
        }
    }
}

/// Output of a development.
#[derive(Debug)]
pub struct Developed<'a> {
    /// The path `r` of unit quaternions, `(frames, joints, 4)`.
    pub reference: &'a mut [f64],
    /// `R`, `(frames, joints, 3)`.
    pub development: &'a mut [f64],
    /// `y`, `(frames, joints, 3)`.
    pub vectors: &'a mut [f64],
}

/// Develops rotations about their reference path.
///
/// # Errors
/// [`Error::Length`] if the lengths of slices do not agree; [`Error::Interrupted`].
pub fn develop<T: Real>(
    input: Input<'_, T>,
    Developed { reference, development, vectors }: Developed<'_>,
    interrupt: &Interrupt,
) -> Result<(), Error> {
    /// Values of a frame of a joint: `r`, `R` and `y`.
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
        (WIDTH, false, true),
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
