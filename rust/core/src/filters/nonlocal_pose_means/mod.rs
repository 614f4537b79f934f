//! Non-local pose means: each pose becomes a weighted mean of the poses with similar neighbourhoods in time.
//!
//! C. J. Dean and J. P. Lewis, "Non-local pose means for denoising motion capture data". With `x_t` the poses as
//! rotation vectors in a chart, patches `P_t = (x_{t−r} … x_{t+r})` and the learning window `|s − t| ≤ k`:
//!
//! ```text
//! f(t, s) = exp(−‖P_s − P_t‖² / 2h²)      s ≠ t;  the square is a mean over the patch's frames and coordinates
//! f(t, t) = max(max_s f(t, s), e⁻⁸⁰)
//! x̂_t     = Σ f(t, s) x_s / Σ f(t, s)
//! ```
//!
//! Along one lag `ℓ = s − t` the patch distance is a sliding sum of per-frame distances. So the cost does not grow
//! with the patch, and lag `ℓ` also serves lag `−ℓ`. The clip is processed in tiles of frames, in parallel. A tile
//! has its own planes: memory beyond input and output is a byte per sample and a few hundred kB per thread.
//!
//! - `path`: the sign-continuous path of each joint and its chart;
//! - `tile`: one tile as planes, and the pairs of frames that it needs;
//! - `patch_distance`: patch distances and weights;
//! - `means`: weighted means, and back to quaternions;
//! - `candidates`: the most similar patches only, by patch search, optionally in a library of other clips;
//! - `kernels`: the vectorised loops.

mod candidates;
mod kernels;
mod means;
mod patch_distance;
mod path;
mod tile;

use crate::error::check_length;
use crate::parallel::{self, Interrupt};
use crate::rotations::quaternion;
use crate::window::{Boundary, Extended};
use crate::{ClipMut, ClipView, Error, Real};
use candidates::Library;
use path::Paths;
use std::ops::Range;
use std::sync::Mutex;
use tile::{Buffers, Clip, Tile};

/// Chart that converts rotations to vectors.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Chart {
    /// The sign-continuous path at each joint's Karcher mean; a joint with too large rotations uses [`Chart::Local`].
    Mean,
    /// The sign-continuous path at the identity: the paper's.
    Identity,
    /// One of the two frames, for each pair of frames.
    Local,
}

/// Joints that share weights.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Weights {
    /// All joints of a pose.
    Pose,
    /// None: each joint has its own weights.
    Joint,
}

/// Combination of squares to a patch distance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Distance {
    /// Mean over the patch's frames and coordinates.
    Mean,
    /// Sum, as in the printed equation.
    Sum,
}

/// The parameters of the filter.
#[derive(Debug, Clone)]
pub struct NonlocalPoseMeans {
    /// Radius of the learning window in frames; `None` for the whole clip.
    pub search_radius: Option<usize>,
    /// Radius of a patch in frames.
    pub patch_radius: usize,
    /// Bandwidth per joint: radians of rotation per coordinate.
    pub bandwidth: Vec<f64>,
    /// Mean or sum of squares.
    pub distance: Distance,
    /// Joints that share weights.
    pub weights: Weights,
    /// Number of most similar patches that have weights; `None` for all.
    pub neighbors: Option<usize>,
    /// Chart that converts rotations to vectors.
    pub chart: Chart,
    /// Continuation of the clip beyond its ends.
    pub boundary: Boundary,
    /// Largest number of later frames that are used; `None` for the whole window.
    pub lookahead: Option<usize>,
}

/// The root's translation, filtered with the weights of the pose (or of the first joint).
#[derive(Debug)]
pub struct Translation<'a, T> {
    /// `(frames, 3)`.
    pub values: &'a [T],
    /// `(frames, 3)`, to be written.
    pub out: &'a mut [T],
}

/// The extent of the window in a clip.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reach {
    /// Number of earlier frames that are candidates.
    pub(super) back: usize,
    /// Number of later frames that are candidates.
    pub(super) ahead: usize,
    /// Frames of a patch before its centre.
    pub(super) before: usize,
    /// Frames of a patch after its centre.
    pub(super) after: usize,
    /// Frames added to the clip at each end.
    pub(super) pad: usize,
    /// Whether added frames are candidates.
    pub(super) added: bool,
}

impl NonlocalPoseMeans {
    /// The joints that share weights.
    fn groups(&self, joints: usize) -> Vec<Range<usize>> {
        match self.weights {
            Weights::Pose => std::iter::once(0..joints).collect(),
            Weights::Joint => (0..joints).map(|joint| joint..joint + 1).collect(),
        }
    }

    /// The extent of the window in a clip of `frames` frames.
    pub(super) fn reach(&self, frames: usize) -> Reach {
        let window = self.search_radius.unwrap_or_else(|| frames.saturating_sub(1));
        let after = self.patch_radius.min(self.lookahead.unwrap_or(usize::MAX));
        Reach {
            back: window,
            ahead: window.min(self.lookahead.map_or(usize::MAX, |ahead| ahead - after)),
            before: self.patch_radius,
            after,
            pad: self.patch_radius + self.search_radius.unwrap_or(0),
            added: self.search_radius.is_some(),
        }
    }

    /// Filters `clip` along time into `out`, `(frames, joints, 4)`, sign-continuous from the hemisphere of the first frame.
    ///
    /// No sample may be missing. `confidence`, `(frames, joints)` in 0…1, weights samples in patch distances and in
    /// means. Quaternions need not have length 1 exactly.
    ///
    /// Frames of `library` are candidates of every frame, at any distance in time; this requires the local chart and
    /// a number of neighbours. Their samples may be missing.
    ///
    /// # Errors
    /// [`Error::Length`] if the lengths of slices do not agree; [`Error::Interrupted`].
    pub fn filter<T: Real>(
        &self,
        clip: ClipView<'_, T>,
        library: Option<&[ClipView<'_, T>]>,
        confidence: Option<&[T]>,
        translation: Option<Translation<'_, T>>,
        out: ClipMut<'_, T>,
        interrupt: &Interrupt,
    ) -> Result<(), Error> {
        let (frames, joints) = (clip.frames(), clip.joints());
        let out = out.into_data();
        check_length("out", clip.data().len(), out.len())?;
        check_length("bandwidth", joints, self.bandwidth.len())?;
        if let Some(confidence) = confidence {
            check_length("confidence", frames * joints, confidence.len())?;
        }
        let (moved, moved_out) = match translation {
            Some(Translation { values, out }) => {
                check_length("translation", frames * 3, values.len())?;
                check_length("translation out", frames * 3, out.len())?;
                (Some(values), out)
            }
            None => (None, &mut [][..]),
        };
        if frames < 2 || joints == 0 {
            moved_out.copy_from_slice(moved.unwrap_or_default());
            return quaternion::normalize(clip.data(), out);
        }
        let reach = self.reach(frames);
        let groups = self.groups(joints);
        let clips = library.unwrap_or_default();
        for other in clips {
            check_length("joints of the library", joints, other.joints())?;
        }
        // If samples of the library are missing, those of the clip need confidences too.
        let shared = confidence.is_some() || clips.iter().any(incomplete);
        let certain = if shared && confidence.is_none() { vec![T::ONE; frames * joints] } else { Vec::new() };
        let confidence = if shared { Some(confidence.unwrap_or(&certain)) } else { None };
        let library = match library {
            Some(clips) => Some(Library::new(self, clip, clips, shared, reach, &groups, interrupt)?),
            None => None,
        };
        let extended = Extended::new(clip, reach.pad, self.boundary);
        let paths = Paths::new(clip, &extended, self.chart, interrupt)?;
        let mut shared = Clip {
            filter: self,
            extended: &extended,
            paths: &paths,
            confidence,
            translation: moved,
            library,
            bounds: Vec::new(),
            reach,
            frames,
        };
        let length = shared.tile_length();
        let bounds = if self.neighbors.is_some() && !reach.added {
            Tile::new(&shared, 0, length.min(frames), &mut Buffers::default()).bounds(interrupt)?
        } else {
            Vec::new()
        };
        shared.bounds = bounds;
        let moved_columns = if moved.is_some() { 3 } else { 0 };
        let tiles: Vec<(&mut [T], &mut [T])> = out
            .chunks_mut(length * joints * 4)
            .zip(chunks_or_empty(moved_out, length * moved_columns))
            .collect();
        let others: usize = clips.iter().map(ClipView::frames).sum();
        let work = frames * joints * (20 + 2 * (reach.back.min(frames) + reach.ahead.min(frames)) + others);
        let pool: Mutex<Vec<Buffers<T>>> = Mutex::default();
        let turned = parallel::map(tiles, work, |index, (out, moved_out)| {
            interrupt.check()?;
            let first = index * length;
            let kept = pool.lock().map_or(None, |mut pool| pool.pop());
            let mut buffers = kept.unwrap_or_default();
            let tile = Tile::new(&shared, first, (first + length).min(frames), &mut buffers);
            let turned = tile.filter(out, moved_out, &mut buffers, interrupt);
            if let Ok(mut pool) = pool.lock() {
                pool.push(buffers);
            }
            turned
        })?;
        let row = joints * 4;
        let meets = |frame: usize| {
            let before = if frame == 0 { &clip.data()[..row] } else { &out[(frame - 1) * row..frame * row] };
            kernels::turns(before.as_chunks().0, out[frame * row..(frame + 1) * row].as_chunks().0)
        };
        if turned.contains(&true) || (0..frames).step_by(length).any(meets) {
            connect(&clip.data()[..row], out);
        }
        Ok(())
    }
}

/// Whether a sample of a clip is missing.
fn incomplete<T: Real>(clip: &ClipView<'_, T>) -> bool {
    clip.data().as_chunks::<4>().0.iter().any(|q| quaternion::is_missing(*q))
}

/// Makes a clip sign-continuous from the hemisphere of `first`.
///
/// Means of a continuous path are usually continuous; a clip with jumps of 180° may leave a sign change.
fn connect<T: Real>(first: &[T], out: &mut [T]) {
    let mut before = first.as_chunks::<4>().0.to_vec();
    let (samples, _) = out.as_chunks_mut::<4>();
    for row in samples.chunks_exact_mut(before.len()) {
        for (q, before) in row.iter_mut().zip(&mut before) {
            if quaternion::dot(*before, *q) < T::ZERO {
                *q = q.map(|x| -x);
            }
            *before = *q;
        }
    }
}

/// Chunks of a slice, or empty ones without end.
fn chunks_or_empty<T>(slice: &mut [T], length: usize) -> Box<dyn Iterator<Item = &mut [T]> + '_> {
    if length == 0 {
        Box::new(std::iter::repeat_with(|| &mut [][..]))
    } else {
        Box::new(slice.chunks_mut(length))
    }
}
