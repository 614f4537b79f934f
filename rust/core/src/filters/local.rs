//! Filters that move each frame by a sum over its neighbours in time: Lee and Shin's construction.
//!
//! With the increments `ω_i = log(q_i⁻¹ q_{i+1})`, a filter determines a half rotation vector `v_i`, a sum of
//! increments around each frame: `q_i exp(v_i)`. The clip is processed in tiles of frames, in parallel. A tile holds
//! the unit quaternions of its frames and of those around them as planes. Each pass extends the previous result.

use super::samples::{LANE, load_local, store_local};
use crate::clip::Planes;
use crate::error::check_length;
use crate::parallel::{self, Interrupt};
use crate::rotations::continuity::make_continuous;
use crate::rotations::quaternion::{self, between, dot, log_short, negative};
use crate::simd::multiversion;
use crate::window::{Boundary, Extended, extended_number};
use crate::{ClipMut, ClipView, Error, Real};
use std::ops::Range;
use std::sync::Mutex;

/// Target size of a tile's planes in bytes: half of a typical second-level cache.
const TILE_BYTES: usize = 256 * 1024;

/// Least and largest number of frames of a tile, unless its surroundings require more.
const TILE_FRAMES: Range<usize> = 128..2048;

/// Planes of a joint: its unit quaternions and the displacements of its frames.
const PER_JOINT: usize = 7;

/// One filter's work on the frames of a tile.
pub(super) trait Local<T: Real>: Sync {
    /// Number of frames before and after a frame that the filter uses.
    fn radius(&self) -> usize;

    /// Estimated nanoseconds per frame and joint.
    fn nanoseconds(&self) -> usize;

    /// Writes the displacements of the frames of a tile: of a joint, and of the translation that moves with it.
    ///
    /// The tile's first frame is at the index `radius` in the planes of `q`. They hold the `frames` of the tile,
    /// `radius` more at either end, and padding up to a multiple of [`LANE`].
    fn moves(
        &self,
        joint: usize,
        frames: usize,
        q: [&[T]; 4],
        paths: &mut [Increments<'_, T>],
        scratch: &mut Planes<T>,
    );
}

/// The increments of a path in three coordinates: of a joint relative to itself, or of the translation.
#[derive(Debug)]
pub(super) struct Increments<'a, T> {
    /// Increments from each frame to the next, starting `radius` frames before the tile.
    pub(super) steps: [&'a [T]; 3],
    /// Displacements of the frames of the tile, to be written; with padding up to a multiple of [`LANE`].
    pub(super) moves: [&'a mut [T]; 3],
}

/// The root's translation, filtered along with the first joint.
#[derive(Debug)]
pub struct Translation<'a, T> {
    /// `(frames, 3)`.
    pub values: &'a [T],
    /// `(frames, 3)`, to be written.
    pub out: &'a mut [T],
}

/// Scratch memory, reused from tile to tile: fresh pages cost as much as the arithmetic.
#[derive(Debug, Default)]
struct Buffers<T> {
    joints: Planes<T>,
    steps: Planes<T>,
    moved: Planes<T>,
    scratch: Planes<T>,
    rows: Vec<[T; 4]>,
}

/// Runs a filter `iterations` times over `clip` into `out`, `(frames, joints, 4)`, sign-continuous from the hemisphere of
/// the first frame.
///
/// # Errors
/// [`Error::Length`] if the lengths of slices do not agree; [`Error::Interrupted`].
pub(super) fn run<T: Real>(
    filter: &impl Local<T>,
    (iterations, boundary): (usize, Boundary),
    clip: ClipView<'_, T>,
    translation: Option<Translation<'_, T>>,
    out: ClipMut<'_, T>,
    interrupt: &Interrupt,
) -> Result<(), Error> {
    let (frames, joints) = (clip.frames(), clip.joints());
    let out = out.into_data();
    check_length("out", clip.data().len(), out.len())?;
    let (values, moved) = match translation {
        Some(Translation { values, out }) => {
            check_length("translation", frames * 3, values.len())?;
            check_length("translation out", frames * 3, out.len())?;
            (values, out)
        }
        None => (&[][..], &mut [][..]),
    };
    if frames < 2 || joints == 0 || iterations == 0 {
        moved.copy_from_slice(values);
        return quaternion::normalize(clip.data(), out);
    }
    pass(filter, boundary, clip, values, out, moved, interrupt)?;
    let (mut before, mut moved_before) = (Vec::new(), Vec::new());
    for _ in 1..iterations {
        before.clear();
        before.extend_from_slice(out);
        moved_before.clear();
        moved_before.extend_from_slice(moved);
        pass(
            filter,
            boundary,
            ClipView::new(&before, frames, joints)?,
            &moved_before,
            out,
            moved,
            interrupt,
        )?;
    }
    let (first, _) = clip.data().as_chunks::<4>();
    let (result, _) = out.as_chunks_mut::<4>();
    for (q, first) in result.iter_mut().zip(&first[..joints]) {
        if dot(*q, *first) < T::ZERO {
            *q = negative(*q);
        }
    }
    make_continuous(out, joints)
}

/// One pass over a clip and a translation, which may be empty.
fn pass<T: Real>(
    filter: &impl Local<T>,
    boundary: Boundary,
    clip: ClipView<'_, T>,
    translation: &[T],
    out: &mut [T],
    moved: &mut [T],
    interrupt: &Interrupt,
) -> Result<(), Error> {
    let (frames, joints) = (clip.frames(), clip.joints());
    let extended = Extended::new(clip, filter.radius(), boundary);
    let fitting = TILE_BYTES / (joints * PER_JOINT * size_of::<T>());
    let length =
        fitting.clamp(TILE_FRAMES.start, TILE_FRAMES.end).max(4 * filter.radius()).next_multiple_of(LANE);
    let columns = if translation.is_empty() { 0 } else { 3 };
    let mut moved = moved.chunks_mut((length * columns).max(1));
    let tiles: Vec<(&mut [T], &mut [T])> =
        out.chunks_mut(length * joints * 4).map(|out| (out, moved.next().unwrap_or_default())).collect();
    let pool: Mutex<Vec<Buffers<T>>> = Mutex::default();
    parallel::for_each(tiles, frames * joints * filter.nanoseconds(), |index, (out, moved)| {
        let kept = pool.lock().map_or(None, |mut pool| pool.pop());
        let mut buffers = kept.unwrap_or_default();
        let first = index * length;
        let own = first..(first + length).min(frames);
        let tile = Tile { filter, extended: &extended, translation, boundary, own };
        tile.filter(out, moved, &mut buffers, interrupt)?;
        if let Ok(mut pool) = pool.lock() {
            pool.push(buffers);
        }
        Ok(())
    })
}

/// Frames of a clip that are filtered together.
struct Tile<'a, T, F> {
    filter: &'a F,
    extended: &'a Extended<'a, T>,
    translation: &'a [T],
    boundary: Boundary,
    own: Range<usize>,
}

impl<T: Real, F: Local<T>> Tile<'_, T, F> {
    fn filter(
        &self,
        out: &mut [T],
        moved: &mut [T],
        buffers: &mut Buffers<T>,
        interrupt: &Interrupt,
    ) -> Result<(), Error> {
        let joints = self.extended.joints();
        let frames = self.own.len();
        let padded = frames.next_multiple_of(LANE);
        let length = padded + 2 * self.filter.radius();
        let Buffers { joints: planes, steps, moved: positions, scratch, rows } = buffers;
        planes.reshape(joints * PER_JOINT, length);
        steps.reshape(6, length);
        positions.reshape(6, length);
        self.load(planes);
        let along = !self.translation.is_empty();
        if along {
            self.load_translation(positions);
        }
        for joint in 0..joints {
            interrupt.check()?;
            let [w, x, y, z, moves @ ..] = planes.rows_mut::<PER_JOINT>(joint * PER_JOINT);
            let q = [&*w, &*x, &*y, &*z];
            let [a, b, c, along_steps @ ..] = steps.rows_mut::<6>(0);
            increments(q, a, b, c);
            let path = Increments { steps: [&*a, &*b, &*c], moves: moves.map(|moves| &mut moves[..padded]) };
            if joint == 0 && along {
                let [px, py, pz, along_moves @ ..] = positions.rows_mut::<6>(0);
                let mut along_steps = along_steps;
                for (steps, positions) in along_steps.iter_mut().zip([&*px, &*py, &*pz]) {
                    differences(positions, steps);
                }
                let translation = Increments {
                    steps: along_steps.map(|steps| &*steps),
                    moves: along_moves.map(|moves| &mut moves[..padded]),
                };
                self.filter.moves(joint, frames, q, &mut [path, translation], scratch);
            } else {
                self.filter.moves(joint, frames, q, &mut [path], scratch);
            }
        }
        self.store(planes, rows, out);
        if along {
            let radius = self.filter.radius();
            for c in 0..3 {
                let (from, by) = (&positions.row(c)[radius..], positions.row(3 + c));
                for ((moved, from), by) in moved[c..].iter_mut().step_by(3).zip(from).zip(by) {
                    *moved = *from + *by;
                }
            }
        }
        Ok(())
    }

    /// The unit quaternions of the tile and its surroundings.
    fn load(&self, planes: &mut Planes<T>) {
        let joints = self.extended.joints();
        // The extended frame `first` is `radius` frames before the tile's first frame.
        let first = self.own.start;
        let range = first..self.own.end + 2 * self.filter.radius();
        for (at, block) in self.extended.blocks(range) {
            let (samples, _) = block.as_chunks::<4>();
            for (chunk, samples) in samples.chunks(LANE * joints).enumerate() {
                let start = at - first + chunk * LANE;
                let range = start..start + samples.len() / joints;
                for joint in 0..joints {
                    let [w, x, y, z] =
                        planes.rows_mut::<4>(joint * PER_JOINT).map(|plane| &mut plane[range.clone()]);
                    load_local(&samples[joint..], joints, w, x, y, z);
                }
            }
        }
    }

    /// The translation of the tile and its surroundings.
    fn load_translation(&self, positions: &mut Planes<T>) {
        let radius = self.filter.radius();
        let loaded = self.own.len() + 2 * radius;
        for column in 0..3 {
            for (i, value) in positions.row_mut(column)[..loaded].iter_mut().enumerate() {
                let index = (self.own.start + i).cast_signed() - radius.cast_signed();
                *value = extended_number(self.translation, 3, column, index, self.boundary, true);
            }
        }
    }

    /// Writes the moved frames to `out`, `(frames, joints, 4)`.
    fn store(&self, planes: &Planes<T>, rows: &mut Vec<[T; 4]>, out: &mut [T]) {
        let joints = self.extended.joints();
        let radius = self.filter.radius();
        rows.resize(LANE * joints, [T::ZERO; 4]);
        let (samples, _) = out.as_chunks_mut::<4>();
        // Rows are assembled in a buffer that stays in the cache, and then written once, in order.
        for (chunk, out) in samples.chunks_mut(LANE * joints).enumerate() {
            let start = chunk * LANE;
            for joint in 0..joints {
                let row = joint * PER_JOINT;
                let at = radius + start;
                let q = planes.rows_from::<4>(row).map(|q| &q[at..at + LANE]);
                let v = planes.rows_from::<3>(row + 4).map(|v| &v[start..start + LANE]);
                store_local(v, q, T::ONE, &mut rows[joint..], joints);
            }
            out.copy_from_slice(&rows[..out.len()]);
        }
    }
}

multiversion! {
    /// Half rotation vectors of the shorter rotation from each frame to the next.
    fn increments<T: Real>(q: [&[T]; 4], x: &mut [T], y: &mut [T], z: &mut [T]) {
        let n = q[0].len();
        let here = q.map(|q| &q[..n - 1]);
        let next = q.map(|q| &q[1..n]);
        let (x, y, z) = (&mut x[..n - 1], &mut y[..n - 1], &mut z[..n - 1]);
        for i in 0..n - 1 {
            let a = [here[0][i], here[1][i], here[2][i], here[3][i]];
            let b = [next[0][i], next[1][i], next[2][i], next[3][i]];
            let v = log_short(between(a, b));
            x[i] = v[0];
            y[i] = v[1];
            z[i] = v[2];
        }
    }
}

multiversion! {
    /// Differences of successive values.
    fn differences<T: Real>(x: &[T], steps: &mut [T]) {
        let n = x.len();
        let (here, next, steps) = (&x[..n - 1], &x[1..n], &mut steps[..n - 1]);
        for i in 0..n - 1 {
            steps[i] = next[i] - here[i];
        }
    }
}
