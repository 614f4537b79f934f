//! Compression to a tolerance: one stream of bits, joint by joint, in principal geodesic coordinates.
//!
//! For each joint it holds what the joint is, which samples are missing, the frame of its coordinates, the length of a step,
//! and as many coordinates as the tolerance needs, each a series of whole numbers. The writer computes what the reader will,
//! measures the largest error, and takes shorter steps, more coordinates or, in the end, the samples as they are, until
//! the tolerance holds. Bits are the same at every SIMD level and for every number of threads, and the reference writes
//! the same stream.

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

/// Joints that are computed together, before they are written one after the other.
const BATCH: usize = 16;

/// Estimated nanoseconds per sample to find out what is written, and to compose what was read.
const NANOSECONDS: usize = 150;

/// A real number whose bits can be stored.
pub trait Stored: Real {
    /// How many bits.
    const BITS: u32;
    /// The bits.
    fn to_plain(self) -> u64;
    /// The number of these bits.
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

/// How a clip is compressed.
#[derive(Debug, Clone)]
pub struct Compress {
    /// What [`principal_frames`] found: two for each joint, of which the one is taken that needs fewer coordinates.
    pub frames: Vec<[[[f64; 4]; 2]; 2]>,
    /// Per joint, the largest rotation angle between a sample and what comes back, radians, above 0.
    pub tolerance: Vec<f64>,
    /// Whether coordinates become whole numbers; else they are stored as floats.
    pub quantised: bool,
}

impl Compress {
    /// The stream of a clip, and the largest error in radians.
    ///
    /// # Errors
    /// [`Error::Length`] if the parameters do not fit the clip; [`Error::Interrupted`].
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

/// The clip of a stream; NaN where samples were missing. Whatever the bytes are, they stand for some clip.
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
