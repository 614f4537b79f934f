//! Clips as planes of unit quaternions.

use crate::clip::Planes;
use crate::parallel::Interrupt;
use crate::rotations::mean::mean;
use crate::rotations::quaternion::{dot, is_missing, unit};
use crate::search::features::{Features, Joint, Kind};
use crate::search::kernels::LANES;
use crate::{ClipView, Error, Real};
use std::ops::Range;

/// Cosine of 45°, plus a margin for rounding. If all samples of a joint are within this half angle of its mean, no
/// two of them are more than 180° apart.
const NARROW: f64 = std::f64::consts::FRAC_1_SQRT_2 + 1e-5;

/// Number of frames whose mean serves as the centre. The result of the search does not depend on it.
const SAMPLE: usize = 1024;

/// Planes of a joint.
const PER_JOINT: usize = 4;

/// Sign convention and distance of each joint of a set of clips.
#[derive(Debug)]
pub(crate) struct Poses<T> {
    /// A rotation in the middle of each joint's samples: samples take the sign nearer to it.
    centres: Vec<[T; 4]>,
    joints: Vec<Joint>,
    complete: bool,
}

/// Consecutive frames of a clip as planes.
#[derive(Debug, Default)]
pub(crate) struct Loaded<T> {
    planes: Planes<T>,
    shares: Option<Planes<T>>,
    joints: Vec<Joint>,
}

impl<T: Real> Loaded<T> {
    pub(crate) fn features(&self) -> Features<'_, T> {
        Features { planes: &self.planes, joints: &self.joints, shares: self.shares.as_ref() }
    }
}

impl<T: Real> Poses<T> {
    /// Scans `clip`, whose means become the centres, and `others`. `shared` requests weights of samples even if none
    /// is missing.
    pub(crate) fn new(
        clip: ClipView<'_, T>,
        others: &[ClipView<'_, T>],
        shared: bool,
        interrupt: &Interrupt,
    ) -> Result<Self, Error> {
        let joints = clip.joints();
        let one = [T::ONE, T::ZERO, T::ZERO, T::ZERO];
        let stride = clip.frames().div_ceil(SAMPLE).max(1);
        let rows = clip.data().chunks_exact(4 * joints.max(1)).step_by(stride);
        let sample: Vec<T> = rows.flatten().copied().collect();
        let sample = ClipView::new(&sample, clip.frames().div_ceil(stride), joints)?;
        let centres: Vec<[T; 4]> = mean(sample, None, interrupt)?
            .iter()
            .map(|centre| if centre[0].is_nan() { one } else { centre.map(T::from_f64) })
            .collect();
        let mut complete = !shared;
        let mut narrow = vec![true; joints];
        for clip in std::iter::once(&clip).chain(others) {
            let (samples, _) = clip.data().as_chunks::<4>();
            for row in samples.chunks_exact(joints) {
                for ((q, centre), narrow) in row.iter().zip(&centres).zip(&mut narrow) {
                    let cosine = dot(*q, *centre);
                    complete &= !is_missing(*q);
                    *narrow &= cosine * cosine >= T::from_f64(NARROW * NARROW) * dot(*q, *q);
                }
            }
        }
        let joints = narrow
            .iter()
            .enumerate()
            .map(|(joint, narrow)| Joint {
                row: joint * PER_JOINT,
                kind: if *narrow { Kind::Narrow } else { Kind::Wide },
            })
            .collect();
        Ok(Self { centres, joints, complete })
    }

    /// Whether no sample is missing and no weights were requested.
    pub(crate) fn complete(&self) -> bool {
        self.complete
    }

    /// Loads frames of a clip with `pad` more at both ends; past the ends of the clip its end frames are repeated.
    pub(crate) fn load(&self, clip: ClipView<'_, T>, frames: Range<usize>, pad: usize, to: &mut Loaded<T>) {
        let joints = self.joints.len();
        let length = frames.len() + 2 * pad + LANES;
        to.joints.clone_from(&self.joints);
        to.planes.reshape(joints * PER_JOINT, length);
        if self.complete {
            to.shares = None;
        } else {
            to.shares.get_or_insert_default().reshape(joints, length);
        }
        let (samples, _) = clip.data().as_chunks::<4>();
        for joint in 0..joints {
            let centre = self.centres[joint];
            let [w, x, y, z] = to.planes.rows_mut::<PER_JOINT>(joint * PER_JOINT);
            for i in 0..length {
                let frame = (frames.start + i).saturating_sub(pad).min(clip.frames() - 1);
                let q = samples[frame * joints + joint];
                let missing = is_missing(q);
                let q = if missing { centre } else { unit(q) };
                let sign = if dot(q, centre) < T::ZERO { -T::ONE } else { T::ONE };
                (w[i], x[i], y[i], z[i]) = (sign * q[0], sign * q[1], sign * q[2], sign * q[3]);
                if let Some(shares) = &mut to.shares {
                    shares.row_mut(joint)[i] = if missing { T::ZERO } else { T::ONE };
                }
            }
        }
    }
}
