//! The nearest candidates found so far.

use super::kernels;
use crate::Real;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Order of two candidates at the same distance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Ties {
    /// The one with the lower index first.
    Lower,
    /// The one nearer in time first; of two equally near ones the earlier.
    Nearer,
}

/// The `count` nearest candidates of consecutive frames, nearest first. The result does not depend on the order of
/// the offers or on repeated offers.
#[derive(Debug)]
pub(crate) struct Nearest<T> {
    count: usize,
    ties: Ties,
    /// Index of the first frame.
    first: usize,
    kept: Vec<usize>,
    distances: Vec<T>,
    numbers: Vec<usize>,
    /// Distance of the farthest candidate kept, per frame; infinite until there are `count`.
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

    /// The candidates kept for a frame: distances and indices.
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

    /// Offers a candidate; it is kept if it is among the `count` nearest and its distance is finite.
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
        let mut index = kept;
        while index > 0 && precedes(index - 1) {
            index -= 1;
        }
        if index > 0 && self.numbers[row + index - 1] == number {
            return;
        }
        self.distances.copy_within(row + index..row + kept, row + index + 1);
        self.numbers.copy_within(row + index..row + kept, row + index + 1);
        self.distances[row + index] = distance;
        self.numbers[row + index] = number;
        self.kept[frame] = kept + 1;
        if kept + 1 == self.count {
            self.limits[frame] = self.distances[row + kept];
        }
    }
}

/// The nearest candidates of consecutive frames in lists of `length` frames each, one lock per list, shared between
/// threads.
#[derive(Debug)]
pub(crate) struct Lists<T> {
    each: Vec<Mutex<Nearest<T>>>,
    /// Index of the first frame.
    first: usize,
    /// Frames per list.
    length: usize,
    /// Candidates per frame.
    count: usize,
}

impl<T: Real> Lists<T> {
    /// For the frames `first..first + frames`, with at most `count` candidates each, in lists of `length` frames.
    pub(crate) fn new(first: usize, frames: usize, length: usize, count: usize, ties: Ties) -> Self {
        let list = |start| Mutex::new(Nearest::new(first + start, length.min(frames - start), count, ties));
        Self { each: (0..frames).step_by(length.max(1)).map(list).collect(), first, length, count }
    }

    /// Largest number of candidates per frame.
    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// The list of a frame, and the frame's index within the list.
    fn list(&self, frame: usize) -> (MutexGuard<'_, Nearest<T>>, usize) {
        let index = frame - self.first;
        let list = self.each[index / self.length].lock();
        (list.unwrap_or_else(PoisonError::into_inner), index % self.length)
    }

    /// Writes the limits of consecutive frames of one list.
    pub(crate) fn read_limits(&self, first: usize, limits: &mut [T]) {
        let (list, index) = self.list(first);
        limits.copy_from_slice(&list.limits[index..index + limits.len()]);
    }

    /// Offers the candidates `number`, `number + 1`, … to consecutive frames of one list, one each.
    pub(crate) fn offer(&self, first: usize, number: usize, distances: &[T], marks: &mut Vec<u8>) {
        let (mut list, index) = self.list(first);
        marks.resize(distances.len(), 0);
        if !kernels::mark_nearest(marks, distances, &list.limits[index..index + distances.len()]) {
            return;
        }
        for (i, distance) in distances.iter().enumerate() {
            if marks[i] != 0 {
                list.offer(index + i, *distance, number + i);
            }
        }
    }

    /// The lists in order.
    pub(crate) fn into_nearest(self) -> impl Iterator<Item = Nearest<T>> {
        self.each.into_iter().map(|list| list.into_inner().unwrap_or_else(PoisonError::into_inner))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_order_of_offers_does_not_matter() {
        let offers = [
            (3.0, 7),
            (1.0, 9),
            (2.0, 1),
            (2.0, 0),
            (f64::INFINITY, 2),
            (2.0, 30),
            (1.0, 4),
            (2.0, 0),
            (1.0, 9),
        ];
        for ties in [Ties::Lower, Ties::Nearer] {
            for shift in 0..offers.len() {
                let mut nearest = Nearest::new(6, 1, 4, ties);
                for i in 0..offers.len() {
                    let (distance, number) = offers[(i * 2 + shift) % offers.len()];
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
