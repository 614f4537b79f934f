//! The most similar patches of one.

use super::NEIGHBORS;
use crate::Real;
use crate::clip::Planes;
use crate::simd::multiversion;

/// Patches whose distances are summed up together.
pub(super) const BLOCK: usize = 32;

/// The nearest patches, and the memory to find them.
#[derive(Debug, Default)]
pub(super) struct Nearest {
    distances: Planes<f64>,
    sorted: Vec<f64>,
    ties: Vec<usize>,
    found: Vec<usize>,
}

impl Nearest {
    /// The patches of `first..end` most like that at `here`, itself among them, in the order of time.
    ///
    /// Among equals those nearer in time come first, then the earlier one. The planes of coefficients go on by [`BLOCK`] beyond
    /// `end`.
    pub(super) fn find(&mut self, patches: &Planes<f64>, here: usize, first: usize, end: usize) -> &[usize] {
        let length = end - first;
        self.distances.reshape(1, length.next_multiple_of(BLOCK));
        squares(patches, here, first, self.distances.row_mut(0));
        let distances = &self.distances.row(0)[..length];
        self.sorted.clear();
        self.sorted.extend_from_slice(distances);
        let count = NEIGHBORS.min(length);
        let (_, &mut farthest, _) = self.sorted.select_nth_unstable_by(count - 1, f64::total_cmp);
        self.found.clear();
        self.ties.clear();
        for (i, &distance) in distances.iter().enumerate() {
            if distance < farthest {
                self.found.push(first + i);
            } else if distance.total_cmp(&farthest).is_eq() {
                self.ties.push(first + i);
            }
        }
        self.ties.sort_by_key(|&i| (i.abs_diff(here), i));
        self.found.extend(self.ties.iter().take(count - self.found.len()));
        &self.found
    }
}

multiversion! {
    /// Squared distances between the patch at `here` and those from `first` on.
    fn squares<T: Real>(patches: &Planes<T>, here: usize, first: usize, out: &mut [T]) {
        for (block, out) in out.chunks_exact_mut(BLOCK).enumerate() {
            let at = first + block * BLOCK;
            let mut sums = [T::ZERO; BLOCK];
            for number in 0..patches.rows() {
                let plane = patches.row(number);
                let x = plane[here];
                let plane = &plane[at..at + BLOCK];
                for i in 0..BLOCK {
                    let difference = plane[i] - x;
                    sums[i] += difference * difference;
                }
            }
            out.copy_from_slice(&sums);
        }
    }
}
