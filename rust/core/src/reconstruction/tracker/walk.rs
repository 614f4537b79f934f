//! From the examples of one frame to those of the next, along a graph of neighbours.
//!
//! J. Chai and J. K. Hodgins, "Performance animation from low-dimensional control signals", 2005. Candidates are the examples of
//! the frame before, their successors, and the neighbours of both in the graph; since not every pose may be an example, those
//! that lie less than a stride away from them. What was lost on the way is found again by full searches, at the start, in regular
//! intervals, and where the last of the nearest is farther than it was.

use super::lattice::Lattice;
use super::search::Example;
use crate::search::poses::graph::Graph;
use crate::search::poses::walk::Fallback;

/// What the frame before tells of the next.
#[derive(Debug, Clone, Default)]
pub(super) struct Walk {
    /// Its examples.
    before: Vec<u32>,
    /// Frames since the last full search; `None`: there was none.
    since: Option<usize>,
    /// The least distance of the last of the nearest since the last full search.
    least: f64,
}

impl Walk {
    /// Whether the graph may be asked.
    pub(super) fn goes_on(&self, fallback: Fallback) -> bool {
        self.since.is_some_and(|since| since < fallback.frames)
    }

    /// Whether examples that were found along the graph are near enough.
    pub(super) fn keeps(&self, found: &[Example], count: usize, fallback: Fallback) -> bool {
        found.len() == count
            && found.last().is_some_and(|last| {
                !fallback.ratio.is_finite() || last.square.sqrt() <= self.least * fallback.ratio
            })
    }

    /// What is known after a frame.
    pub(super) fn follow(&self, found: &[Example], full: bool) -> Self {
        let last = found.last().map_or(0.0, |last| last.square.sqrt());
        Self {
            before: found.iter().filter_map(|one| u32::try_from(one.pose).ok()).collect(),
            since: Some(if full { 0 } else { self.since.map_or(0, |since| since + 1) }),
            least: if full { last } else { self.least.min(last) },
        }
    }

    /// Candidates up to two strides from the examples of the frame before, which rise.
    pub(super) fn near(&self, lattice: &Lattice) -> Vec<u32> {
        let far = lattice.stride() + 1;
        let of_one = |&pose: &u32| {
            let pose = pose as usize;
            [pose.saturating_sub(far), pose, pose + far].into_iter().flat_map(|at| lattice.beside(at))
        };
        let mut near: Vec<u32> = self.before.iter().flat_map(of_one).collect();
        near.sort_unstable();
        near.dedup();
        near
    }

    /// Candidates near the examples of the frame before, the poses after them, and the neighbours of both; they rise.
    pub(super) fn around(&self, lattice: &Lattice, graph: Graph<'_>, seen: &mut Vec<u64>) -> Vec<u32> {
        seen.resize(lattice.words(), 0);
        let mut near = Vec::new();
        for &before in &self.before {
            for pose in [before as usize, before as usize + 1] {
                for at in std::iter::once(pose).chain(graph.of(pose)) {
                    for candidate in lattice.beside(at) {
                        let (word, bit) = (candidate as usize / 64, 1 << (candidate % 64));
                        if seen[word] & bit == 0 {
                            seen[word] |= bit;
                            near.push(candidate);
                        }
                    }
                }
            }
        }
        for &candidate in &near {
            seen[candidate as usize / 64] = 0;
        }
        // In the order of the memory.
        near.sort_unstable();
        near
    }
}
