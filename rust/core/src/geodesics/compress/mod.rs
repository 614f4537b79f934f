//! Compression within a tolerance: one bit stream, joint by joint, in principal geodesic coordinates.
//!
//! For each joint the stream holds its kind, the missing samples, the frame of its coordinates, the length of a step,
//! and as many coordinates as the tolerance needs, each a series of integers. The writer computes the reader's result
//! and measures its largest error. Until the tolerance holds, it takes shorter steps, more coordinates or finally the
//! unchanged samples. The bits are the same at every SIMD level and for every number of threads, and the reference
//! writes the same stream.

mod bits;
mod chart;
mod fit;
mod frames;
mod joint;
mod numbers;
mod series;

pub use frames::principal_frames;

use crate::error::check_length;
use crate::parallel::{self, Interrupt};
use crate::rotations::quaternion::is_missing;
use crate::{ClipMut, ClipView, Error, Real};
use bits::{Reader, Writer};
use joint::{Contexts, Joint};

/// Joints that are computed together before they are written in order.
const BATCH: usize = 16;

/// Estimated nanoseconds per sample of the encoding decisions, and of decoding.
const NANOSECONDS: usize = 150;

/// A real type whose bits can be stored.
pub trait Stored: Real {
    /// Number of bits.
    const BITS: u32;
    /// The bits.
    fn to_plain(self) -> u64;
    /// The number with these bits.
    fn from_plain(bits: u64) -> Self;
}

impl Stored for f32 {
    const BITS: u32 = 32;
    fn to_plain(self) -> u64 {
        u64::from(self.to_bits())
    }
    #[allow(clippy::cast_possible_truncation, reason = "the upper bits are 0")]
    fn from_plain(bits: u64) -> Self {
        Self::from_bits(bits as u32)
    }
}

impl Stored for f64 {
    const BITS: u32 = 64;
    fn to_plain(self) -> u64 {
        self.to_bits()
    }
    fn from_plain(bits: u64) -> Self {
        Self::from_bits(bits)
    }
}

/// Parameters of the compression.
#[derive(Debug, Clone)]
pub struct Compress {
    /// Result of [`principal_frames`]: two frames for each joint, of which the one that needs fewer coordinates is
    /// used.
    pub frames: Vec<[[[f64; 4]; 2]; 2]>,
    /// Tolerance per joint: the largest rotation angle between a sample and its decoded value, radians, above 0.
    pub tolerance: Vec<f64>,
    /// Whether coordinates are stored as integers; otherwise as floats.
    pub quantised: bool,
}

impl Compress {
    /// The stream of a clip, and the largest error in radians.
    ///
    /// # Errors
    /// [`Error::Length`] if the number of frames or tolerances is not that of the joints; [`Error::Interrupted`].
    pub fn compress<T: Stored>(
        &self,
        clip: ClipView<'_, T>,
        interrupt: &Interrupt,
    ) -> Result<(Vec<u8>, f64), Error> {
        let (frames, joints) = (clip.frames(), clip.joints());
        check_length("frames", joints, self.frames.len())?;
        check_length("tolerance", joints, self.tolerance.len())?;
        let (mut writer, mut contexts) = (Writer::new(), Contexts::new());
        let mut worst = 0.0_f64;
        for first in (0..joints).step_by(BATCH) {
            let batch: Vec<usize> = (first..(first + BATCH).min(joints)).collect();
            let work = batch.len() * frames * NANOSECONDS;
            let found = parallel::map(batch, work, |_, joint| {
                interrupt.check()?;
                let mut missing = vec![false; frames];
                let mut valid = Vec::with_capacity(frames);
                for (frame, missing) in missing.iter_mut().enumerate() {
                    let q = clip.at(frame, joint);
                    *missing = is_missing(q);
                    if !*missing {
                        valid.push(q.map(Real::to_f64));
                    }
                }
                let (frames, tolerance) = (self.frames[joint], self.tolerance[joint]);
                Joint::new::<T>(valid, missing, frames, (tolerance, self.quantised), interrupt)
            })?;
            for joint in found {
                joint.write::<T>(&mut writer, &mut contexts, interrupt)?;
                worst = worst.max(joint.error);
            }
        }
        Ok((writer.finish(), worst))
    }
}

/// Decodes a clip; NaN where samples are missing. Every sequence of bytes decodes to some clip.
///
/// # Errors
/// [`Error::Interrupted`].
pub fn decompress<T: Stored>(data: &[u8], out: ClipMut<'_, T>, interrupt: &Interrupt) -> Result<(), Error> {
    let (frames, joints) = (out.frames(), out.joints());
    let out = out.into_data();
    let (mut reader, mut contexts) = (Reader::new(data), Contexts::new());
    for first in (0..joints).step_by(BATCH) {
        let count = BATCH.min(joints - first);
        let mut batch = Vec::with_capacity(count);
        for _ in 0..count {
            batch.push(Joint::read::<T>(&mut reader, frames, &mut contexts, interrupt)?);
        }
        let paths = parallel::map(batch, count * frames * NANOSECONDS / 4, |_, joint| {
            interrupt.check()?;
            let mut path = joint.path::<T>().into_iter();
            let all: Vec<[T; 4]> = joint
                .missing()
                .iter()
                .map(|&missing| match if missing { None } else { path.next() } {
                    Some(q) => q.map(T::from_f64),
                    None => [T::nan(); 4],
                })
                .collect();
            Ok(all)
        })?;
        for (frame, row) in out.chunks_exact_mut(4 * joints).enumerate() {
            for (out, path) in row[4 * first..].chunks_exact_mut(4).zip(&paths) {
                out.copy_from_slice(&path[frame]);
            }
        }
    }
    Ok(())
}
