//! Candidate examples of the next frame, along a graph of neighbours.
//!
//! J. Chai and J. K. Hodgins, "Performance animation from low-dimensional control signals", 2005. The candidates are
//! the examples of the previous frame, their successors, and the neighbours of both in the graph. Since not every
//! pose may be an example, the candidates less than a stride away from these are taken. Full searches recover
//! neighbours that the walk has lost: at the start, at regular intervals, and when the last neighbour is farther than
//! expected.

use super::lattice::Lattice;
use super::search::Example;
use crate::search::poses::graph::Graph;
use crate::search::poses::walk::Fallback;

/// State of the walk after the previous frame.
#[derive(Debug, Clone, Default)]
pub(super) struct Walk {
    /// The examples of the previous frame.
    before: Vec<u32>,
    /// Frames since the last full search; `None`: there was none.
    since: Option<usize>,
    /// The smallest distance of the last neighbour since the last full search.
    least: f64,
}

impl Walk {
    /// Whether the next search may use the graph.
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

    /// The state after a frame.
    pub(super) fn follow(&self, found: &[Example], full: bool) -> Self {
        let last = found.last().map_or(0.0, |last| last.square.sqrt());
        Self {
            before: found.iter().filter_map(|one| u32::try_from(one.pose).ok()).collect(),
            since: Some(if full { 0 } else { self.since.map_or(0, |since| since + 1) }),
            least: if full { last } else { self.least.min(last) },
        }
    }

    /// Candidates up to two strides from the examples of the previous frame, in ascending order.
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

    /// Candidates near the examples of the previous frame, near their successors, and near the neighbours of both; in
    /// ascending order.
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
        // In memory order.
        near.sort_unstable();
        near
    }
}
