//! Spikes: samples that leave the motion and come back at once.
//!
//! A run of samples shorter than the radius is a spike if it is farther than usual from everything that its neighbours
//! explain: the rest or the straight motion of either side, and the way from one side to the other. What is usual is the
//! median of the same deviation over the runs around it, and at least that of white noise of the joint's level.
//!
//! Two of the explanations are the nearest neighbours themselves: where the steps into a run and out of it are short,
//! nothing else has to be computed.

use crate::error::check_length;
use crate::parallel::{self, Interrupt};
use crate::rotations::quaternion::{between, exp_one, log_short, product, unit};
use crate::{ClipView, Error, Real};
use std::cmp::Ordering;
use std::ops::Range;

/// Median deviation of samples of white noise with the deviation 1 per coordinate.
const DEVIATION_OF_NOISE: f64 = 1.5;

/// A spike is farther away than the joint moves in so many frames.
const MOTION: f64 = 2.0;

/// Neighbours and surroundings are looked for among so many radii of frames on either side.
const SURROUNDINGS: usize = 3;

/// How often the clip is looked at: for spikes, for those that they hid, and for what only seemed to be one beside them.
const LOOKS: usize = 3;

/// By how much the first and cheap test may err.
const SLACK: f64 = 1e-9;

/// What is a spike.
#[derive(Debug, Clone)]
pub struct Despike {
    /// Deviation of the noise per coordinate and joint: radians of rotation, or the unit of the positions.
    pub noise: Vec<f64>,
    /// Deviations up to here are no spikes, per joint: radians of rotation, or the unit of the positions.
    pub smallest: Vec<f64>,
    /// Spikes are shorter: frames. On either side at most so many neighbours are asked.
    pub radius: usize,
    /// How many times the usual deviation a spike is away.
    pub threshold: f64,
}

/// What moves: a rotation or a position.
trait Place: Copy + Send + Sync {
    /// The way from `self` to `to`: a rotation vector in radians, or a difference.
    fn step(self, to: Self) -> [f64; 3];

    /// What lies one step from `self`.
    fn moved(self, step: [f64; 3]) -> Self;

    /// A number that grows with the distance, and costs less.
    fn nearness(self, to: Self) -> f64;

    /// The same number for a distance.
    fn nearness_at(distance: f64) -> f64;

    fn distance(self, to: Self) -> f64 {
        length(self.step(to))
    }
}

/// A unit quaternion.
#[derive(Debug, Clone, Copy)]
struct Rotation([f64; 4]);

impl Place for Rotation {
    fn step(self, to: Self) -> [f64; 3] {
        log_short(between(self.0, to.0)).map(|x| 2.0 * x)
    }

    fn moved(self, step: [f64; 3]) -> Self {
        Self(product(self.0, exp_one(step.map(|x| x / 2.0))))
    }

    fn nearness(self, to: Self) -> f64 {
        let [_, x, y, z] = between(self.0, to.0);
        x * x + y * y + z * z
    }

    fn nearness_at(distance: f64) -> f64 {
        if distance < std::f64::consts::PI {
            let (sine, _) = Real::sin_cos(distance / 2.0);
            sine * sine
        } else {
            f64::INFINITY
        }
    }
}

#[derive(Debug, Clone, Copy)]
struct Position([f64; 3]);

impl Place for Position {
    fn step(self, to: Self) -> [f64; 3] {
        std::array::from_fn(|c| to.0[c] - self.0[c])
    }

    fn moved(self, step: [f64; 3]) -> Self {
        Self(std::array::from_fn(|c| self.0[c] + step[c]))
    }

    fn nearness(self, to: Self) -> f64 {
        let [x, y, z] = self.step(to);
        x * x + y * y + z * z
    }

    fn nearness_at(distance: f64) -> f64 {
        distance * distance
    }
}

fn length([x, y, z]: [f64; 3]) -> f64 {
    (x * x + y * y + z * z).sqrt()
}

impl Despike {
    /// Marks the spikes of a clip of rotations in `found`, `(frames, joints)`. No sample may be missing.
    ///
    /// # Errors
    /// [`Error::Length`] if slices do not fit together; [`Error::Interrupted`].
    pub fn rotations<T: Real>(
        &self,
        clip: ClipView<'_, T>,
        confidence: Option<&[T]>,
        found: &mut [bool],
        interrupt: &Interrupt,
    ) -> Result<(), Error> {
        let at = |frame, joint| Rotation(unit(clip.at(frame, joint).map(T::to_f64)));
        self.run((clip.frames(), clip.joints()), at, confidence, found, interrupt)
    }

    /// Marks the spikes of positions `(frames, points, 3)` in `found`, `(frames, points)`.
    ///
    /// # Errors
    /// [`Error::Length`] if slices do not fit together; [`Error::Interrupted`].
    pub fn positions<T: Real>(
        &self,
        values: &[T],
        (frames, points): (usize, usize),
        confidence: Option<&[T]>,
        found: &mut [bool],
        interrupt: &Interrupt,
    ) -> Result<(), Error> {
        check_length("positions", frames * points * 3, values.len())?;
        let at = |frame, point| {
            let i = (frame * points + point) * 3;
            Position([values[i], values[i + 1], values[i + 2]].map(T::to_f64))
        };
        self.run((frames, points), at, confidence, found, interrupt)
    }

    fn run<T: Real, P: Place>(
        &self,
        (frames, joints): (usize, usize),
        at: impl Fn(usize, usize) -> P + Sync,
        confidence: Option<&[T]>,
        found: &mut [bool],
        interrupt: &Interrupt,
    ) -> Result<(), Error> {
        check_length("found", frames * joints, found.len())?;
        check_length("noise", joints, self.noise.len())?;
        check_length("smallest", joints, self.smallest.len())?;
        if let Some(confidence) = confidence {
            check_length("confidence", frames * joints, confidence.len())?;
        }
        found.fill(false);
        let columns = parallel::map((0..joints).collect(), found.len() * 20, |_, joint: usize| {
            let trust = confidence.map(|c| c.iter().skip(joint).step_by(joints));
            let joint = Joint {
                path: (0..frames).map(|frame| at(frame, joint)).collect(),
                trust: trust.map_or_else(|| vec![1.0; frames], |c| c.map(|x| x.to_f64()).collect()),
                usual: DEVIATION_OF_NOISE * self.noise[joint],
                smallest: self.smallest[joint],
                radius: self.radius,
                threshold: self.threshold,
            };
            joint.spikes(interrupt)
        })?;
        for (joint, column) in columns.into_iter().enumerate() {
            for frame in column {
                found[frame * joints + joint] = true;
            }
        }
        Ok(())
    }
}

/// One joint, and what is a spike there.
struct Joint<P> {
    path: Vec<P>,
    trust: Vec<f64>,
    usual: f64,
    smallest: f64,
    radius: usize,
    threshold: f64,
}

/// The trusted samples next to a run on either side, the nearest first.
#[derive(Debug, Default)]
struct Sides {
    earlier: Vec<usize>,
    later: Vec<usize>,
}

impl<P: Place> Joint<P> {
    /// The frames of the spikes.
    fn spikes(&self, interrupt: &Interrupt) -> Result<Vec<usize>, Error> {
        let mut found = Vec::new();
        for _ in 0..LOOKS {
            interrupt.check()?;
            let seen = self.look(&found);
            if seen == found {
                break;
            }
            found = seen;
        }
        Ok(found)
    }

    /// The frames of the spikes, given those that were found before; in order.
    fn look(&self, before: &[usize]) -> Vec<usize> {
        let mut trusted: Vec<bool> = self.trust.iter().map(|&trust| trust > 0.0).collect();
        for &frame in before {
            trusted[frame] = false;
        }
        let mut found = Vec::new();
        let mut sides = Sides::default();
        let sure = P::nearness_at(self.least(1.0)) * (1.0 - SLACK);
        for length in 1..self.radius {
            for start in 0..(self.path.len() + 1).saturating_sub(length) {
                let run = start..start + length;
                let doubt = &self.trust[run.clone()];
                if !doubt.iter().all(|&trust| trust > 0.0) {
                    continue;
                }
                let doubt = doubt.iter().copied().fold(0.0, f64::max);
                let bound =
                    if doubt < 1.0 { P::nearness_at(self.least(doubt)) * (1.0 - SLACK) } else { sure };
                let Some((a, b)) = self.ends(&run, &trusted) else { continue };
                let (into, out) = (&self.path[start], &self.path[run.end - 1]);
                if self.path[a].nearness(*into) <= bound || out.nearness(self.path[b]) <= bound {
                    continue;
                }
                if self.is_spike(&run, doubt, &trusted, &mut sides) {
                    found.extend(run);
                }
            }
        }
        found.sort_unstable();
        found.dedup();
        found
    }

    /// The least deviation of a spike, whatever is around it.
    fn least(&self, doubt: f64) -> f64 {
        self.smallest.max(self.threshold * doubt * self.usual)
    }

    /// The frames before and after a run among which neighbours are looked for, nearest first.
    fn near(&self, run: &Range<usize>) -> (impl Iterator<Item = usize>, impl Iterator<Item = usize>) {
        let reach = SURROUNDINGS * self.radius;
        let earlier = (run.start.saturating_sub(reach)..run.start).rev();
        let later = run.end..(run.end + reach).min(self.path.len());
        (earlier, later)
    }

    /// The nearest trusted samples on either side.
    fn ends(&self, run: &Range<usize>, trusted: &[bool]) -> Option<(usize, usize)> {
        let (mut earlier, mut later) = self.near(run);
        earlier.find(|&frame| trusted[frame]).zip(later.find(|&frame| trusted[frame]))
    }

    fn is_spike(&self, run: &Range<usize>, doubt: f64, trusted: &[bool], sides: &mut Sides) -> bool {
        let Some(away) = self.deviation(run, trusted, sides) else { return false };
        if away <= self.least(doubt) || away <= MOTION * self.pace(sides) {
            return false;
        }
        let reach = SURROUNDINGS * self.radius;
        let length = run.len();
        let before = run.start.saturating_sub(reach)..(run.start + 1).saturating_sub(length);
        let last = (run.start + reach + 1).min((self.path.len() + 1).saturating_sub(length));
        let mut around: Vec<f64> = before
            .chain(run.end..last)
            .map(|start| start..start + length)
            .filter(|run| trusted[run.clone()].iter().all(|&trusted| trusted))
            .filter_map(|run| self.deviation(&run, trusted, sides))
            .collect();
        away > self.threshold * doubt * median(&mut around)
    }

    /// How far a run is from where its neighbours would have it, at the sample and by the explanation that fit best;
    /// `None` without a neighbour on either side. The neighbours are left in `sides`.
    fn deviation(&self, run: &Range<usize>, trusted: &[bool], sides: &mut Sides) -> Option<f64> {
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
    fn pace(&self, sides: &Sides) -> f64 {
        let pairs = sides.earlier.windows(2).chain(sides.later.windows(2));
        let mut moves: Vec<f64> = pairs
            .map(|pair| self.path[pair[0]].distance(self.path[pair[1]]) / pair[0].abs_diff(pair[1]) as f64)
            .collect();
        median(&mut moves)
    }
}

/// The straight line of least squares through places in time, as seen from the first of them.
struct Line<P> {
    from: P,
    /// At the frame that times are counted from.
    value: [f64; 3],
    /// Per frame.
    slope: [f64; 3],
}

impl<P: Place> Line<P> {
    /// The line through `path` at `frames`, of which there is at least one; times are counted from `origin`.
    fn through(path: &[P], frames: &[usize], origin: usize) -> Self {
        let from = path[frames[0]];
        let count = frames.len() as f64;
        let time = |frame: usize| frame as f64 - origin as f64;
        let mean = frames.iter().map(|&frame| time(frame)).sum::<f64>() / count;
        let (mut value, mut slope, mut spread) = ([0.0; 3], [0.0; 3], 0.0);
        for &frame in frames {
            let vector = from.step(path[frame]);
            let off = time(frame) - mean;
            spread += off * off;
            for c in 0..3 {
                value[c] += vector[c] / count;
                slope[c] += off * vector[c];
            }
        }
        let slope = slope.map(|x| x / spread.max(1.0));
        Self { from, value: std::array::from_fn(|c| value[c] - mean * slope[c]), slope }
    }

    fn at(&self, steps: f64) -> P {
        self.from.moved(std::array::from_fn(|c| self.value[c] + steps * self.slope[c]))
    }
}

/// The median, of an even count the mean of the two in the middle; 0 of none.
fn median(values: &mut [f64]) -> f64 {
    let n = values.len();
    if n == 0 {
        return 0.0;
    }
    values.sort_unstable_by(|a, b| a.partial_cmp(b).unwrap_or(Ordering::Equal));
    f64::midpoint(values[(n - 1) / 2], values[n / 2])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians_of_few() {
        assert_eq!(median(&mut []), 0.0);
        assert_eq!(median(&mut [3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(&mut [4.0, 1.0, 2.0, 8.0]), 3.0);
    }

    #[test]
    fn the_cheap_measure_grows_with_the_distance() {
        let turned = |angle: f64| Rotation(exp_one([0.0, angle / 2.0, 0.0]));
        for angle in [1e-9, 0.1, 1.0, 3.0] {
            let measured = turned(0.0).nearness(turned(angle));
            assert!((measured / Rotation::nearness_at(angle) - 1.0).abs() < SLACK, "{angle}");
        }
        assert_eq!(Rotation::nearness_at(4.0), f64::INFINITY);
    }
}
