//! The most similar patches found so far.

use crate::Real;

/// Which of two candidates at the same distance comes first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Ties {
    /// The one with the lower number.
    Lower,
    /// The one nearer in time; of two equally near ones the earlier.
    Nearer,
}

/// The `count` nearest candidates of some frames, nearest first. What is kept does not depend on the order of the offers.
#[derive(Debug)]
pub(crate) struct Nearest<T> {
    count: usize,
    ties: Ties,
    /// The number of the first frame.
    first: usize,
    kept: Vec<usize>,
    distances: Vec<T>,
    numbers: Vec<usize>,
    /// Candidates farther than this are not kept; infinite until there are `count`.
    limits: Vec<T>,
}

impl<T: Real> Nearest<T> {
    /// For the frames `first..first + frames`, with at most `count` candidates each.
    pub(crate) fn new(first: usize, frames: usize, count: usize, ties: Ties) -> Self {
        let infinite = T::ONE / T::ZERO;
        Self {
            count,
            ties,
            first,
            kept: vec![0; frames],
            distances: vec![infinite; frames * count],
            numbers: vec![0; frames * count],
            limits: vec![infinite; frames],
        }
    }

    /// How far the last one that is kept is, per frame.
    pub(crate) fn limits(&self) -> &[T] {
        &self.limits
    }

    /// What is kept for a frame: distances and numbers.
    pub(crate) fn of(&self, frame: usize) -> impl Iterator<Item = (T, usize)> {
        let row = frame * self.count..frame * self.count + self.kept[frame];
        self.distances[row.clone()].iter().copied().zip(self.numbers[row].iter().copied())
    }

    fn rank(&self, frame: usize, number: usize) -> usize {
        match self.ties {
            Ties::Lower => number,
            Ties::Nearer => {
                2 * number.abs_diff(self.first + frame) + usize::from(number > self.first + frame)
            }
        }
    }

    /// Offers a candidate; infinitely far ones are never kept.
    pub(crate) fn offer(&mut self, frame: usize, distance: T, number: usize) {
        let row = frame * self.count;
        let mut kept = self.kept[frame];
        if !distance.is_finite() || distance > self.limits[frame] || self.count == 0 {
            return;
        }
        let precedes = |other: usize| {
            let (d, n) = (self.distances[row + other], self.numbers[row + other]);
            distance < d || (distance == d && self.rank(frame, number) < self.rank(frame, n))
        };
        if kept == self.count {
            if !precedes(kept - 1) {
                return;
            }
            kept -= 1;
        }
        let mut place = kept;
        while place > 0 && precedes(place - 1) {
            place -= 1;
        }
        self.distances.copy_within(row + place..row + kept, row + place + 1);
        self.numbers.copy_within(row + place..row + kept, row + place + 1);
        self.distances[row + place] = distance;
        self.numbers[row + place] = number;
        self.kept[frame] = kept + 1;
        if kept + 1 == self.count {
            self.limits[frame] = self.distances[row + kept];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_order_of_offers_does_not_matter() {
        let offers = [(3.0, 7), (1.0, 9), (2.0, 1), (2.0, 0), (f64::INFINITY, 2), (2.0, 30), (1.0, 4)];
        for ties in [Ties::Lower, Ties::Nearer] {
            for shift in 0..offers.len() {
                let mut nearest = Nearest::new(6, 1, 4, ties);
                for i in 0..offers.len() {
                    let (distance, number) = offers[(i * 3 + shift) % offers.len()];
                    nearest.offer(0, distance, number);
                }
                let expected = match ties {
                    Ties::Lower => [(1.0, 4), (1.0, 9), (2.0, 0), (2.0, 1)],
                    Ties::Nearer => [(1.0, 4), (1.0, 9), (2.0, 1), (2.0, 0)],
                };
                assert_eq!(nearest.of(0).collect::<Vec<_>>(), expected, "{ties:?} {shift}");
            }
        }
    }
}
