//! Coordinates of all candidates side by side, and the bounds from their inner products with other frames.

use super::axes::GROUP;
use super::kernels::LANES;
use crate::Real;
use crate::search::diagonal::Measure;
use crate::search::kernels::sliding_sums;

/// Rounding errors, in units of the last place, by which a computed distance may fall below its bound.
const ROUNDINGS: f64 = 512.0;

/// Half squared length of a padding column: too large for any pair to be near.
const NEVER: f64 = 1e37;

/// Square root of the value that stands for an unknown limit.
const ALWAYS: f64 = 1e18;

/// Candidates' coordinates in panels of [`LANES`] columns: the first coordinates of all columns of a panel, then the
/// second ones.
#[derive(Debug)]
pub(super) struct Stage<T> {
    /// Coordinates of a column.
    pub(super) dims: usize,
    /// Number of leading groups whose products keep their sign.
    pub(super) signed: usize,
    /// Columns past the end of a tile that its patches need.
    pub(super) border: usize,
    pub(super) panels: Vec<T>,
    /// Half the squared length of each candidate.
    pub(super) halves: Vec<T>,
    /// Largest distance between a candidate and the patches that it represents.
    pub(super) radii: Vec<T>,
    /// Factor below 1 by which half squared lengths are reduced to allow for rounding.
    keep: T,
    /// Converts a distance to the square root of a sum of squares: √divisor.
    scale: T,
    /// Absolute rounding error of such a square root.
    slack: T,
    /// Rounding error of the projections, per unit of the longest projected vector.
    share: T,
    /// Length of the candidates' longest vector.
    longest: T,
}

/// Consecutive panels.
#[derive(Debug)]
pub(super) struct Panels<'a, T> {
    numbers: &'a mut [T],
    dims: usize,
}

impl<T: Real> Panels<'_, T> {
    /// Writes a group of coordinates, from the index `first` on, for the first columns.
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
    /// Allocates the arrays for `count` candidates in tiles of `tile`.
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

    /// Splits the panels into tasks of `length` columns.
    pub(super) fn tasks(&mut self, length: usize) -> Vec<Panels<'_, T>> {
        let dims = self.dims;
        self.panels.chunks_mut(length * dims).map(|numbers| Panels { numbers, dims }).collect()
    }

    /// Sets each candidate's half squared length from the squares of its columns.
    pub(super) fn add_up(&mut self, squares: &[T], window: usize) {
        let count = squares.len() + 1 - window.min(squares.len() + 1);
        let mut halves = vec![T::ZERO; count];
        self.half(&mut squares.to_vec(), window, &mut halves);
        self.halves[..count].copy_from_slice(&halves);
    }

    /// Half the sliding sums of squares, reduced by their possible rounding errors.
    pub(super) fn half(&self, squares: &mut Vec<T>, window: usize, halves: &mut [T]) {
        sliding_sums(squares, &mut Vec::new(), window, halves);
        for half in halves {
            *half *= T::HALF * self.keep;
        }
    }

    /// Sets the rounding error of projections: each coordinate is a sum of `terms` products, and the longest
    /// projected vector has the length `longest`.
    pub(super) fn project(&mut self, terms: usize, longest: T) {
        self.share = T::EPSILON * T::from_f64(4.0 * terms as f64);
        self.longest = longest;
    }

    /// Sets the largest distance between each candidate and the patches that it represents.
    pub(super) fn set_radii(&mut self, radii: &[T]) {
        self.radii[..radii.len()].copy_from_slice(radii);
    }

    /// Converts a limit of distances to the scale of the coordinates, with rounding allowed for. `longest` is the
    /// length of the frames' longest vector.
    pub(super) fn reach(&self, limit: T, longest: T) -> T {
        let slack = self.slack + self.share * self.longest.max(longest);
        (limit * self.scale * above::<T>() + slack).min(T::from_f64(ALWAYS))
    }
}

/// Factor above 1 that makes up for rounding errors.
pub(super) fn above<T: Real>() -> T {
    T::from_f64(1.0 + ROUNDINGS * T::EPSILON.to_f64())
}
