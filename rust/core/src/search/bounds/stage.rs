//! Numbers of many frames side by side, and what their inner products with other frames' tell.

use super::axes::GROUP;
use super::kernels::LANES;
use crate::Real;
use crate::search::diagonal::Measure;
use crate::search::kernels::sliding_sums;

/// Roundings, in units of the last place, by which a distance may be less than its bound.
const ROUNDINGS: f64 = 512.0;

/// Half a square that no sum of products comes near to.
const NEVER: f64 = 1e37;

/// The root of what stands for a limit that is not known.
const ALWAYS: f64 = 1e18;

/// Candidates' numbers, in panels of [`LANES`] columns: the first numbers of all columns of a panel, then the second ones.
#[derive(Debug)]
pub(super) struct Stage<T> {
    /// Numbers of a column.
    pub(super) dims: usize,
    /// How many groups of numbers keep the signs of their products.
    pub(super) signed: usize,
    /// Columns beyond a tile that belong to it.
    pub(super) border: usize,
    pub(super) panels: Vec<T>,
    /// Half the squares of the numbers of each candidate.
    pub(super) halves: Vec<T>,
    /// How far what a candidate stands for may be from it.
    pub(super) radii: Vec<T>,
    /// What is left of a half square if roundings take their share.
    keep: T,
    /// The root of a sum of squares for each unit of a distance.
    scale: T,
    /// What roundings of the numbers add to such a root.
    slack: T,
    /// What they add for each unit of the longest of the vectors that the numbers are coordinates of.
    share: T,
    /// The longest vector of the candidates.
    longest: T,
}

/// Some panels in sequence.
#[derive(Debug)]
pub(super) struct Panels<'a, T> {
    numbers: &'a mut [T],
    dims: usize,
}

impl<T: Real> Panels<'_, T> {
    /// Writes a group of numbers, from the one with the number `first`, of the first columns.
    pub(super) fn write(&mut self, first: usize, group: [&[T]; GROUP]) {
        for (i, plane) in group.into_iter().enumerate() {
            for (panel, values) in self.numbers.chunks_exact_mut(self.dims * LANES).zip(plane.chunks(LANES)) {
                let at = (first + i) * LANES;
                panel[at..at + values.len()].copy_from_slice(values);
            }
        }
    }
}

impl<T: Real> Stage<T> {
    /// Room for the candidates of a side.
    pub(super) fn new(
        measure: &Measure<T>,
        dims: usize,
        signed: usize,
        count: usize,
        tile: usize,
        border: usize,
    ) -> Self {
        let tiles = count.next_multiple_of(tile);
        let columns = (tiles + border).next_multiple_of(LANES);
        let roundings = (dims / GROUP + LANES + GROUP) as f64;
        let factors: f64 = measure.factors[measure.joints.clone()].iter().map(|factor| factor.to_f64()).sum();
        let size = 2.0 * (factors * measure.window() as f64).sqrt();
        Self {
            dims,
            signed,
            border,
            panels: vec![T::ZERO; columns * dims],
            halves: vec![T::from_f64(NEVER); tiles],
            radii: vec![T::ZERO; tiles],
            keep: T::from_f64(1.0 - roundings * T::EPSILON.to_f64()),
            scale: T::from_f64(measure.divisor().sqrt()),
            slack: T::EPSILON * T::from_f64(16.0 * size),
            share: T::ZERO,
            longest: T::ZERO,
        }
    }

    /// The panels of `length` columns each.
    pub(super) fn tasks(&mut self, length: usize) -> Vec<Panels<'_, T>> {
        let dims = self.dims;
        self.panels.chunks_mut(length * dims).map(|numbers| Panels { numbers, dims }).collect()
    }

    /// Adds up the squares of the columns of each candidate.
    pub(super) fn add_up(&mut self, squares: &[T], window: usize) {
        let count = squares.len() + 1 - window.min(squares.len() + 1);
        let mut halves = vec![T::ZERO; count];
        self.half(&mut squares.to_vec(), window, &mut halves);
        self.halves[..count].copy_from_slice(&halves);
    }

    /// Half the sums of squares, less what roundings may have added.
    pub(super) fn half(&self, squares: &mut Vec<T>, window: usize, halves: &mut [T]) {
        sliding_sums(squares, &mut Vec::new(), window, halves);
        for half in halves {
            *half *= T::HALF * self.keep;
        }
    }

    /// Tells that numbers are coordinates, each a sum of so many `terms`, of vectors of which the longest is so long.
    pub(super) fn project(&mut self, terms: usize, longest: T) {
        self.share = T::EPSILON * T::from_f64(4.0 * terms as f64);
        self.longest = longest;
    }

    /// Tells how far what each candidate stands for may be from it.
    pub(super) fn set_radii(&mut self, radii: &[T]) {
        self.radii[..radii.len()].copy_from_slice(radii);
    }

    /// What a limit of distances comes to, for frames whose longest vector is so long.
    pub(super) fn reach(&self, limit: T, longest: T) -> T {
        let slack = self.slack + self.share * self.longest.max(longest);
        (limit * self.scale * above::<T>() + slack).min(T::from_f64(ALWAYS))
    }
}

/// What makes up for roundings.
pub(super) fn above<T: Real>() -> T {
    T::from_f64(1.0 + ROUNDINGS * T::EPSILON.to_f64())
}
