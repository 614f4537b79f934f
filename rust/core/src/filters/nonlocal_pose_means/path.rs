//! The sign-continuous path of each joint over the extended clip, and the chart that holds it.

use super::Chart;
use crate::parallel::{self, Interrupt};
use crate::rotations::mean::mean;
use crate::rotations::quaternion::dot;
use crate::simd::multiversion;
use crate::window::Extended;
use crate::{ClipView, Error, Real};

/// Cosine of the largest half angle from the mean that one chart holds: three quarters of a full turn of rotation. Near
/// a full turn the chart stretches without bound.
const CHART_LIMIT: f64 = -std::f64::consts::FRAC_1_SQRT_2;

/// Frames per task.
const TASK_FRAMES: usize = 1024;

/// How a joint's rotations become vectors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum JointChart<T> {
    /// Logarithm at a fixed rotation.
    Fixed([T; 4]),
    /// Logarithm at each frame.
    Local,
}

/// The paths of all joints.
#[derive(Debug)]
pub(super) struct Paths<T> {
    /// The chart of each joint.
    pub(super) charts: Vec<JointChart<T>>,
    /// 1 where the sample's sign is turned, `(extended frames, joints)`.
    flips: Vec<u8>,
}

/// What a task learns of each joint, signs counted from the task's first frame.
#[derive(Debug, Clone, Copy)]
struct Extent<T> {
    sum: T,
    least: T,
    most: T,
}

impl<T: Real> Paths<T> {
    pub(super) fn new(
        clip: ClipView<'_, T>,
        extended: &Extended<'_, T>,
        chart: Chart,
        interrupt: &Interrupt,
    ) -> Result<Self, Error> {
        let (frames, joints, pad) = (extended.frames(), extended.joints(), extended.pad());
        let one = [1.0, 0.0, 0.0, 0.0];
        let centres = match chart {
            Chart::Mean => mean(clip, None, interrupt)?,
            Chart::Identity | Chart::Local => vec![one; joints],
        };
        let centres: Vec<[T; 4]> = centres.iter().map(|m| m.map(T::from_f64)).collect();
        let mut flips = vec![0_u8; frames * joints];
        let tasks: Vec<&mut [u8]> = flips.chunks_mut(TASK_FRAMES * joints).collect();
        let extents = parallel::map(tasks, frames * joints * 2, |task, flips| {
            interrupt.check()?;
            Ok(follow(extended, task * TASK_FRAMES, flips, &centres, pad..pad + clip.frames()))
        })?;

        // Signs counted from each task's first frame become signs counted from the first frame of all.
        let mut turned = vec![0_u8; joints];
        let mut sum = vec![0.0; joints];
        let mut least = vec![f64::INFINITY; joints];
        let mut most = vec![f64::NEG_INFINITY; joints];
        let mut starts = Vec::with_capacity(extents.len());
        for (task, extents) in extents.iter().enumerate() {
            starts.push(turned.clone());
            let end = ((task + 1) * TASK_FRAMES).min(frames) - 1;
            for (joint, extent) in extents.iter().enumerate() {
                let extent = Extent {
                    sum: extent.sum.to_f64(),
                    least: extent.least.to_f64(),
                    most: extent.most.to_f64(),
                };
                let extent = if turned[joint] == 1 {
                    Extent { sum: -extent.sum, least: -extent.most, most: -extent.least }
                } else {
                    extent
                };
                sum[joint] += extent.sum;
                least[joint] = least[joint].min(extent.least);
                most[joint] = most[joint].max(extent.most);
                turned[joint] ^= flips[end * joints + joint];
            }
        }

        // The whole path may still be turned: to the mean's hemisphere, or at the identity to `w ≥ 0` in the first frame.
        let mut charts = Vec::with_capacity(joints);
        let mut whole = vec![0_u8; joints];
        for joint in 0..joints {
            let first = starts[pad / TASK_FRAMES][joint] ^ flips[pad * joints + joint];
            let turn = match chart {
                Chart::Mean => sum[joint] < 0.0,
                Chart::Identity => (clip.at(0, joint)[0] < T::ZERO) != (first == 1),
                Chart::Local => first == 1,
            };
            whole[joint] = u8::from(turn);
            let far = if turn { -most[joint] } else { least[joint] };
            charts.push(match chart {
                Chart::Local => JointChart::Local,
                Chart::Mean if far < CHART_LIMIT => JointChart::Local,
                Chart::Mean | Chart::Identity => JointChart::Fixed(centres[joint]),
            });
        }
        let tasks: Vec<&mut [u8]> = flips.chunks_mut(TASK_FRAMES * joints).collect();
        parallel::for_each(tasks, frames * joints / 16, |task, flips| {
            let start: Vec<u8> = starts[task].iter().zip(&whole).map(|(a, b)| a ^ b).collect();
            if start.contains(&1) {
                for row in flips.chunks_exact_mut(joints) {
                    for (flip, start) in row.iter_mut().zip(&start) {
                        *flip ^= start;
                    }
                }
            }
            Ok(())
        })?;
        Ok(Self { charts, flips })
    }

    /// Makes the filtered clip sign-continuous from the hemisphere of the input's first frame.
    ///
    /// Means of a continuous path are continuous as a rule; a clip that jumps by half turns may still leave a flip.
    pub(super) fn connect(&self, clip: ClipView<'_, T>, out: &mut [T]) -> Result<(), Error> {
        let (frames, joints) = (clip.frames(), clip.joints());
        let (first, _) = clip.data()[..joints * 4].as_chunks::<4>();
        let (samples, _) = out.as_chunks::<4>();
        let tasks: Vec<usize> = (0..frames).step_by(TASK_FRAMES).collect();
        let turns = parallel::map(tasks, frames * joints, |_, start| {
            let end = (start + TASK_FRAMES).min(frames);
            let rows = &samples[start.saturating_sub(1) * joints..end * joints];
            let inside = turns_anywhere(rows, &rows[joints.min(rows.len())..]);
            Ok(inside || (start == 0 && turns_anywhere(first, rows)))
        })?;
        if !turns.contains(&true) {
            return Ok(());
        }
        let (samples, _) = out.as_chunks_mut::<4>();
        let mut before = first.to_vec();
        for row in samples.chunks_exact_mut(joints) {
            for (q, before) in row.iter_mut().zip(&mut before) {
                if dot(*before, *q) < T::ZERO {
                    *q = q.map(|x| -x);
                }
                *before = *q;
            }
        }
        Ok(())
    }

    /// The sign by which the path turns a sample, as 1 or −1.
    #[inline(always)]
    pub(super) fn sign(&self, frame: usize, joint: usize) -> T {
        if self.flips[frame * self.charts.len() + joint] == 0 { T::ONE } else { -T::ONE }
    }
}

/// Marks the flips of the rows of one task, the first row's sign being what it is, and measures `m · q` along the path.
///
/// The first row of a task is compared with the row before it, so that tasks can be chained. Sums are taken over `own`
/// frames only.
fn follow<T: Real>(
    extended: &Extended<'_, T>,
    first: usize,
    flips: &mut [u8],
    centres: &[[T; 4]],
    own: std::ops::Range<usize>,
) -> Vec<Extent<T>> {
    let joints = centres.len();
    let end = first + flips.len() / joints;
    let mut before: Option<&[[T; 4]]> = first.checked_sub(1).map(|frame| extended.row(frame));
    let mut extents = vec![Extent { sum: T::ZERO, least: T::from_f64(2.0), most: T::from_f64(-2.0) }; joints];
    let mut turned = vec![0_u8; joints];
    for (at, rows) in extended.blocks(first..end) {
        let (samples, _) = rows.as_chunks::<4>();
        for (i, row) in samples.chunks_exact(joints).enumerate() {
            let frame = at + i;
            let out = &mut flips[(frame - first) * joints..(frame - first + 1) * joints];
            follow_row(
                before.unwrap_or(row),
                row,
                centres,
                &mut turned,
                out,
                &mut extents,
                own.contains(&frame),
            );
            before = Some(row);
        }
    }
    extents
}

multiversion! {
    fn follow_row<T: Real>(
        before: &[[T; 4]],
        row: &[[T; 4]],
        centres: &[[T; 4]],
        turned: &mut [u8],
        flips: &mut [u8],
        extents: &mut [Extent<T>],
        own: bool,
    ) {
        let n = row.len();
        let (before, centres, turned) = (&before[..n], &centres[..n], &mut turned[..n]);
        let (flips, extents) = (&mut flips[..n], &mut extents[..n]);
        let share = if own { T::ONE } else { T::ZERO };
        for j in 0..n {
            turned[j] ^= u8::from(dot(before[j], row[j]) < T::ZERO);
            flips[j] = turned[j];
            let scalar = dot(centres[j], row[j]) / dot(row[j], row[j]).sqrt();
            let scalar = if turned[j] == 0 { scalar } else { -scalar };
            extents[j].sum += share * scalar;
            extents[j].least = extents[j].least.min(scalar);
            extents[j].most = extents[j].most.max(scalar);
        }
    }
}

multiversion! {
    /// Whether any pair has a negative inner product.
    fn turns_anywhere<T: Real>(before: &[[T; 4]], after: &[[T; 4]]) -> bool {
        /// Pairs at once: one vector of float32 at the widest level.
        const PAIRS: usize = 16;
        let mut least = [T::ZERO; PAIRS];
        let n = before.len().min(after.len());
        let (before, before_rest) = before[..n].as_chunks::<PAIRS>();
        let (after, after_rest) = after[..n].as_chunks::<PAIRS>();
        for (a, b) in before.iter().zip(after) {
            for i in 0..PAIRS {
                least[i] = least[i].min(dot(a[i], b[i]));
            }
        }
        let rest = before_rest.iter().zip(after_rest).any(|(a, b)| dot(*a, *b) < T::ZERO);
        rest || least.iter().any(|&x| x < T::ZERO)
    }
}
