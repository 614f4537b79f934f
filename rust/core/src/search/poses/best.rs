//! The nearest segments found so far.

use crate::Real;

/// The `count` nearest of the segments offered, nearest first. Ties go to the lower index.
#[derive(Debug, Clone)]
pub struct Best<T> {
    count: usize,
    found: Vec<(T, usize)>,
}

impl<T: Real> Best<T> {
    /// An empty list.
    #[must_use]
    pub fn new(count: usize) -> Self {
        Self { count, found: Vec::new() }
    }

    /// Largest number of segments kept.
    #[must_use]
    pub fn count(&self) -> usize {
        self.count
    }

    /// Empties the list.
    pub fn clear(&mut self) {
        self.found.clear();
    }

    /// Squared distances and indices, nearest first.
    #[must_use]
    pub fn found(&self) -> &[(T, usize)] {
        &self.found
    }

    /// Squared distance of the last segment kept; `None` until there are `count`.
    #[inline(always)]
    #[must_use]
    pub fn limit(&self) -> Option<T> {
        if self.found.len() < self.count { None } else { self.found.last().map(|last| last.0) }
    }

    /// Inserts a segment if it is among the nearest and its distance is finite.
    #[inline(always)]
    pub fn offer(&mut self, square: T, number: usize) {
        if self.limit().is_none_or(|limit| square <= limit) {
            self.insert(square, number);
        }
    }

    fn insert(&mut self, square: T, number: usize) {
        if !square.is_finite() || self.count == 0 {
            return;
        }
        let at = self
            .found
            .partition_point(|&(other, index)| other < square || (other == square && index < number));
        if self.found.get(at) == Some(&(square, number)) {
            return; // offered before
        }
        if self.found.len() == self.count {
            if at == self.count {
                return;
            }
            self.found.pop();
        }
        self.found.insert(at, (square, number));
    }

    /// Writes indices and distances; −1 and infinity for missing entries.
    pub fn write<I: Copy + From<i32> + TryFrom<usize>>(&self, indices: &mut [I], distances: &mut [T]) {
        indices.fill(I::from(-1));
        distances.fill(T::ONE / T::ZERO);
        for ((index, distance), &(square, number)) in indices.iter_mut().zip(distances).zip(&self.found) {
            // The conversion cannot fail: a matrix of poses has no index that large.
            *index = I::try_from(number).unwrap_or(I::from(-1));
            *distance = square.sqrt();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_stay_and_ties_go_to_the_lower_number() {
        let mut best = Best::new(3);
        for (square, number) in
            [(4.0, 0), (1.0, 9), (f64::NAN, 1), (1.0, 2), (f64::INFINITY, 3), (4.0, 7), (1.0, 4)]
        {
            best.offer(square, number);
        }
        assert_eq!(best.found(), [(1.0, 2), (1.0, 4), (1.0, 9)]);
        let (mut indices, mut distances) = ([0_i64; 4], [0.0; 4]);
        best.write(&mut indices, &mut distances);
        assert_eq!((indices, distances), ([2, 4, 9, -1], [1.0, 1.0, 1.0, f64::INFINITY]));
    }
}
