//! The sign-continuous path of each joint over the extended clip, and its chart.

use super::Chart;
use crate::parallel::{self, Interrupt};
use crate::rotations::mean::mean;
use crate::rotations::quaternion::lower;
use crate::simd::multiversion;
use crate::window::Extended;
use crate::{ClipView, Error, Real};

/// Cosine of the largest half angle from the mean within one chart: a rotation of 270°. Near 360° the chart is
/// unbounded.
const CHART_LIMIT: f64 = -std::f64::consts::FRAC_1_SQRT_2;

/// Frames per task.
const TASK_FRAMES: usize = 1024;

/// Chart of a joint's rotations.
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
    /// 1 where the sample's sign is changed, `(extended frames, joints)`.
    flips: Vec<u8>,
}

/// Cosines of each joint in a task, with signs relative to the task's first frame.
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

        // Converts signs relative to each task's first frame to signs relative to the very first frame.
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

        // The sign of the whole path: towards the mean's hemisphere, or at the identity `w ≥ 0` in the first frame.
        let mut charts = Vec::with_capacity(joints);
        let mut whole = vec![0_u8; joints];
        for joint in 0..joints {
            let first = starts[pad / TASK_FRAMES][joint] ^ flips[pad * joints + joint];
            let turn = match chart {
                Chart::Mean => sum[joint] < 0.0,
                Chart::Identity => lower(clip.at(0, joint)) != (first == 1),
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

    /// 1 where the path changes the sign of a sample, for a range of frames: `(frames, joints)`.
    pub(super) fn flips(&self, frames: std::ops::Range<usize>) -> &[u8] {
        let joints = self.charts.len();
        &self.flips[frames.start * joints..frames.end * joints]
    }

    /// Sign of a sample in the path, 1 or −1.
    #[inline(always)]
    pub(super) fn sign(&self, frame: usize, joint: usize) -> T {
        if self.flips[frame * self.charts.len() + joint] == 0 { T::ONE } else { -T::ONE }
    }
}

/// Joints that are processed together: one vector of float32 at the widest level.
const COLUMNS: usize = 16;

/// Frames that are processed column by column: their rows fit in the first-level cache.
const CHUNK_FRAMES: usize = 16;

/// Marks the sign changes in the rows of one task, and measures the cosine of the half angle to the centres along the
/// path.
///
/// The first row of a task is compared with the row before it, so that tasks can be chained. Sums are over the `own`
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
    let start = extended.row(first.saturating_sub(1));
    let width = COLUMNS.min(joints);
    // The last columns overlap the previous ones, so that all groups have the same width.
    let columns: Vec<usize> = (0..joints).step_by(COLUMNS).map(|column| column.min(joints - width)).collect();
    let mut states: Vec<State<T>> = columns
        .iter()
        .map(|&column| {
            let range = column..column + width;
            State::new(&start[range.clone()], &centres[range])
        })
        .collect();
    for (at, rows) in extended.blocks(first..end) {
        let flips = &mut flips[(at - first) * joints..];
        let chunks = rows.chunks(CHUNK_FRAMES * joints * 4).zip(flips.chunks_mut(CHUNK_FRAMES * joints));
        for (chunk, (rows, flips)) in chunks.enumerate() {
            let at = at + chunk * CHUNK_FRAMES;
            let inside = own.start.saturating_sub(at)..own.end.saturating_sub(at);
            for (&column, state) in columns.iter().zip(&mut states) {
                let samples = rows.as_chunks::<4>().0;
                follow_columns(state, samples, flips, joints, column, width, inside.clone());
            }
        }
    }
    (0..joints)
        .map(|joint| {
            let block = joint / COLUMNS;
            let (state, c) = (&states[block], joint - columns[block]);
            Extent { sum: state.sum[c], least: state.least[c], most: state.most[c] }
        })
        .collect()
}

/// Path state of some joints at a frame.
struct State<T> {
    centre: [[T; COLUMNS]; 4],
    before: [[T; COLUMNS]; 4],
    sign: [T; COLUMNS],
    sum: [T; COLUMNS],
    least: [T; COLUMNS],
    most: [T; COLUMNS],
}

impl<T: Real> State<T> {
    fn new(before: &[[T; 4]], centres: &[[T; 4]]) -> Self {
        Self {
            centre: turned(centres),
            before: turned(before),
            sign: [T::ONE; COLUMNS],
            sum: [T::ZERO; COLUMNS],
            least: [T::TWO; COLUMNS],
            most: [-T::TWO; COLUMNS],
        }
    }
}

/// Up to [`COLUMNS`] quaternions, transposed to four rows of components.
#[inline(always)]
fn turned<T: Real>(samples: &[[T; 4]]) -> [[T; COLUMNS]; 4] {
    let mut row = [[T::ONE; 4]; COLUMNS];
    row[..samples.len()].copy_from_slice(samples);
    let mut q = [[T::ZERO; COLUMNS]; 4];
    for c in 0..COLUMNS {
        q[0][c] = row[c][0];
        q[1][c] = row[c][1];
        q[2][c] = row[c][2];
        q[3][c] = row[c][3];
    }
    q
}

multiversion! {
    /// Processes the joints `column..column + width` along rows of samples; `own` rows enter the sums.
    fn follow_columns<T: Real>(
        state: &mut State<T>,
        samples: &[[T; 4]],
        flips: &mut [u8],
        joints: usize,
        column: usize,
        width: usize,
        own: std::ops::Range<usize>,
    ) {
        let State { centre, before, sign, sum, least, most } = state;
        let rows = samples.chunks_exact(joints).zip(flips.chunks_exact_mut(joints)).enumerate();
        for (frame, (row, flips)) in rows {
            let row = &row[column..column + width];
            let q = if width == COLUMNS { turned(&row[..COLUMNS]) } else { turned(row) };
            let share = if own.contains(&frame) { T::ONE } else { T::ZERO };
            let mut marks = [0_u8; COLUMNS];
            for c in 0..COLUMNS {
                let [w, x, y, z] = [q[0][c], q[1][c], q[2][c], q[3][c]];
                let step = (before[0][c] * w + before[1][c] * x) + (before[2][c] * y + before[3][c] * z);
                let cosine = (centre[0][c] * w + centre[1][c] * x) + (centre[2][c] * y + centre[3][c] * z);
                let square = (w * w + x * x) + (y * y + z * z);
                sign[c] = if step < T::ZERO { -sign[c] } else { sign[c] };
                let cosine = sign[c] * cosine / square.sqrt();
                sum[c] += share * cosine;
                least[c] = least[c].min(cosine);
                most[c] = most[c].max(cosine);
                marks[c] = u8::from(sign[c] < T::ZERO);
            }
            *before = q;
            if width == COLUMNS {
                flips[column..column + COLUMNS].copy_from_slice(&marks);
            } else {
                flips[column..column + width].copy_from_slice(&marks[..width]);
            }
        }
    }
}
