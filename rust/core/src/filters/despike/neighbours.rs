//! The neighbours of a run, and where they would have its samples.

use super::joint::Joint;
use super::line::Line;
use super::median::median;
use super::place::Place;
use std::ops::Range;

/// Neighbours and surroundings are looked for among so many radii of frames on either side.
pub(super) const SURROUNDINGS: usize = 3;

/// The trusted samples next to a run on either side, the nearest first.
#[derive(Debug, Default)]
pub(super) struct Sides {
    earlier: Vec<usize>,
    later: Vec<usize>,
}

impl<P: Place> Joint<P> {
    /// The frames before and after a run among which neighbours are looked for, nearest first.
    fn near(&self, run: &Range<usize>) -> (impl Iterator<Item = usize>, impl Iterator<Item = usize>) {
        let reach = SURROUNDINGS * self.radius;
        let earlier = (run.start.saturating_sub(reach)..run.start).rev();
        let later = run.end..(run.end + reach).min(self.path.len());
        (earlier, later)
    }

    /// How far a run is from where its neighbours would have it, at the sample and by the explanation that fit best;
    /// `None` without a neighbour on either side. The neighbours are left in `sides`.
    pub(super) fn deviation(&self, run: &Range<usize>, trusted: &[bool], sides: &mut Sides) -> Option<f64> {
        let (earlier, later) = self.near(run);
        sides.earlier.clear();
        sides.earlier.extend(earlier.filter(|&frame| trusted[frame]).take(self.radius));
        sides.later.clear();
        sides.later.extend(later.filter(|&frame| trusted[frame]).take(self.radius));
        let (&first, &last) = (sides.earlier.first()?, sides.later.first()?);
        let (a, b) = (self.path[first], self.path[last]);
        let way = a.step(b);
        let before = Line::through(&self.path, &sides.earlier, run.start);
        let after = Line::through(&self.path, &sides.later, run.start);
        let mut least = f64::INFINITY;
        for frame in run.clone() {
            let part = (frame - first) as f64 / (last - first) as f64;
            let steps = (frame - run.start) as f64;
            let across = a.moved(way.map(|x| part * x));
            for expected in [a, b, before.at(steps), after.at(steps), across] {
                least = least.min(self.path[frame].distance(expected));
            }
        }
        Some(least)
    }

    /// The median of the movements per frame from one neighbour to the next on its side; 0 without any.
    pub(super) fn pace(&self, sides: &Sides) -> f64 {
        let pairs = sides.earlier.windows(2).chain(sides.later.windows(2));
        let mut moves: Vec<f64> = pairs
            .map(|pair| self.path[pair[0]].distance(self.path[pair[1]]) / pair[0].abs_diff(pair[1]) as f64)
            .collect();
        median(&mut moves)
    }
}
