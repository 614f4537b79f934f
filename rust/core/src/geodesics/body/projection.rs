//! Exact nearest point of a geodesic to a pose.
//!
//! `g(s) = Σ_j h_j(n_j s)` is a sum over the joints. Each term is convex up to a kink, where the joint is 180° away
//! from its sample. With `w ≥ 0` and `|n_j s| ≤ π/2` a joint has at most one kink, at `θ = θ* ∓ π/2`, `θ* = atan2(p,
//! w)`. Between two kinks `g` is convex, and Newton's method finds the minimum. The interval around `s = 0` nearly
//! always contains the lowest one: beyond its kink a joint cannot come nearer than `arccos |p|`.

use super::distance::{Kept, Sums, View, add_views, keep_views, view};
use super::poses::{Lane, Part, TILE, Tile, sample};
use crate::Real;
use crate::simd::multiversion;
use std::f64::consts::FRAC_PI_2;

/// Largest number of Newton steps; three to five suffice, and each moves at least one end of the bracket.
const STEPS: usize = 60;

/// Step length, relative to the bracket's largest parameter, below which steps are rounding errors.
const SHORTEST: f64 = 4.0 * f64::EPSILON;

/// Step length, relative to the same, after which the next Newton step would be shorter than rounding errors.
const QUADRATIC: f64 = 1e-8;

/// Relative improvement by which an interval must be lower than the one around 0 to be chosen.
const LOWER: f64 = 1e-12;

/// Nearest points of a tile of poses.
pub(super) struct Nearest {
    /// Sums at the nearest points; the bends are not updated.
    pub(super) sums: Sums,
    pub(super) kept: Vec<Kept>,
}

/// Largest parameter: the fastest joint has rotated by 180°, `π/2` on S³, and would rotate back beyond it.
pub(super) fn furthest(v: &[Part]) -> f64 {
    FRAC_PI_2 / v.iter().fold(0.0, |most, part| f64::max(most, part.length))
}

/// Moves the parameters `s` of a tile of poses to the nearest points, and computes the samples relative to them.
pub(super) fn nearest_points(tile: &Tile, v: &[Part], chordal: bool, s: &mut Lane) -> Nearest {
    let end = furthest(v);
    let mut search = Search::new(s, -end, end);
    let mut reach = Lane([-1.0; TILE]);
    for &part in v {
        find_kinks(&tile[part.joint], part, end, &mut search.low, &mut search.high, &mut reach);
    }
    search.begin(s);
    for _ in 0..STEPS {
        let mut sums = Sums::ZERO;
        add_views(tile, v, s, chordal, &mut sums);
        let mut over = true;
        for i in 0..TILE {
            over &= search.step(i, sums.pull.0[i], sums.bend.0[i], s);
        }
        if over {
            break;
        }
    }
    let mut nearest = Nearest { sums: Sums::ZERO, kept: vec![[Lane::ZERO; 3]; v.len()] };
    keep_views(tile, v, s, chordal, &mut nearest.sums, &mut nearest.kept);
    for i in 0..TILE {
        let square = nearest.sums.square.0[i];
        if reach.0[i] >= 0.0 && square > least_beyond(reach.0[i], chordal) {
            let moved = if chordal {
                elsewhere::<true>(tile, v, end, i, square)
            } else {
                elsewhere::<false>(tile, v, end, i, square)
            };
            if let Some(moved) = moved {
                s.0[i] = moved;
                nearest.see(tile, v, chordal, i, moved);
            }
        }
    }
    nearest
}

/// Lower bound of a joint's square beyond its kink, for `|p| = reach`.
fn least_beyond(reach: f64, chordal: bool) -> f64 {
    let cosine = reach.min(1.0);
    if chordal {
        return 2.0 * (1.0 - cosine);
    }
    let angle = (1.0 - cosine * cosine).sqrt().atan2_nonnegative(cosine);
    angle * angle
}

impl Nearest {
    /// Computes a pose relative to another point.
    fn see(&mut self, tile: &Tile, v: &[Part], chordal: bool, i: usize, s: f64) {
        self.sums.square.0[i] = 0.0;
        self.sums.pull.0[i] = 0.0;
        for (part, [factor, along, sinc]) in v.iter().zip(&mut self.kept) {
            let x = sample(&tile[part.joint], i);
            let seen =
                if chordal { view::<true>(x, *part, s, None) } else { view::<false>(x, *part, s, None) };
            self.sums.square.0[i] += seen.square;
            self.sums.pull.0[i] += part.length * (seen.factor * seen.along);
            factor.0[i] = seen.factor;
            along.0[i] = seen.along;
            sinc.0[i] = seen.sinc;
        }
    }
}

multiversion! {
    /// Narrows the brackets around 0 to the kinks of a joint; `reach` becomes the largest `|p|` of the joints with a
    /// kink.
    fn find_kinks(
        samples: &[Lane; 4],
        part: Part,
        end: f64,
        low: &mut Lane,
        high: &mut Lane,
        reach: &mut Lane,
    ) {
        let [w, x, y, z] = samples;
        let e = part.axis;
        // There is a kink only if θ* is beyond π/2 − n·end.
        let (sin, cos) = Real::sin_cos(part.length * end);
        let mut p = Lane::ZERO;
        let mut most = Lane([-1.0; TILE]);
        for i in 0..TILE {
            p.0[i] = x.0[i] * e[0] + y.0[i] * e[1] + z.0[i] * e[2];
            let kinked = (p.0[i].abs() * sin > w.0[i] * cos) & (part.length > 0.0);
            most.0[i] = if kinked { p.0[i].abs() } else { -1.0 };
        }
        if most.0.iter().all(|&most| most < 0.0) {
            return;
        }
        for i in 0..TILE {
            let theta = p.0[i].abs().atan2_nonnegative(w.0[i]);
            let kink = (FRAC_PI_2 - theta) / part.length;
            let kinked = (most.0[i] >= 0.0) & (kink < end);
            // A sample on one side has its kink on the other.
            low.0[i] = if kinked & (p.0[i] > 0.0) & (-kink > low.0[i]) { -kink } else { low.0[i] };
            high.0[i] = if kinked & (p.0[i] < 0.0) & (kink < high.0[i]) { kink } else { high.0[i] };
            reach.0[i] = if kinked & (most.0[i] > reach.0[i]) { most.0[i] } else { reach.0[i] };
        }
    }
}

/// Brackets of the minima, and which of their ends have been tried.
struct Search {
    low: Lane,
    high: Lane,
    shortest: Lane,
    tried: [[bool; 2]; TILE],
}

impl Search {
    fn new(s: &Lane, low: f64, high: f64) -> Self {
        Self { low: Lane([low; TILE]), high: Lane([high; TILE]), shortest: *s, tried: [[false; 2]; TILE] }
    }

    /// Clamps the parameters to the brackets.
    fn begin(&mut self, s: &mut Lane) {
        for i in 0..TILE {
            s.0[i] = s.0[i].max(self.low.0[i]).min(self.high.0[i]);
            self.shortest.0[i] = self.low.0[i].abs().max(self.high.0[i].abs());
        }
    }

    /// One Newton step for one pose, limited by its bracket; returns whether it was the last.
    ///
    /// A step that would leave the bracket goes to its end, or to the middle if that end has been tried.
    fn step(&mut self, i: usize, pull: f64, bend: f64, s: &mut Lane) -> bool {
        let at = s.0[i];
        if pull >= 0.0 {
            self.low.0[i] = at;
            self.tried[i][0] = true;
        }
        if pull <= 0.0 {
            self.high.0[i] = at;
            self.tried[i][1] = true;
        }
        let (low, high) = (self.low.0[i], self.high.0[i]);
        let newton = if pull == 0.0 { at } else { at + pull / bend };
        let middle = f64::midpoint(low, high);
        let (next, free) = if newton < low {
            (if self.tried[i][0] { middle } else { low }, false)
        } else if newton > high {
            (if self.tried[i][1] { middle } else { high }, false)
        } else {
            (newton, true)
        };
        s.0[i] = next;
        (next - at).abs() <= self.shortest.0[i] * if free { QUADRATIC } else { SHORTEST }
    }
}

/// The parameter of the lowest minimum of all other intervals, if it is lower than `square`.
fn elsewhere<const CHORDAL: bool>(tile: &Tile, v: &[Part], end: f64, i: usize, square: f64) -> Option<f64> {
    let x: Vec<[f64; 4]> = v.iter().map(|part| sample(&tile[part.joint], i)).collect();
    let mut borders = vec![-end, end];
    for (x, part) in x.iter().zip(v) {
        let p = x[1] * part.axis[0] + x[2] * part.axis[1] + x[3] * part.axis[2];
        let kink = (FRAC_PI_2 - p.abs().atan2_nonnegative(x[0])) / part.length;
        if kink < end && p != 0.0 {
            borders.push(-kink.copysign(p));
        }
    }
    borders.sort_by(f64::total_cmp);
    let mut best = (square * (1.0 - LOWER), None);
    for piece in borders.windows(2) {
        let middle = f64::midpoint(piece[0], piece[1]);
        let signs: Vec<f64> = x
            .iter()
            .zip(v)
            .map(|(x, part)| view::<CHORDAL>(*x, *part, middle, None).factor.signum())
            .collect();
        let seen = |s: f64| {
            let views = x.iter().zip(v).zip(&signs);
            views.map(move |((x, part), sign)| (part.length, view::<CHORDAL>(*x, *part, s, Some(*sign))))
        };
        let mut search = Search::new(&Lane::ZERO, piece[0], piece[1]);
        let mut s = Lane([middle; TILE]);
        search.begin(&mut s);
        for _ in 0..STEPS {
            let add = |(pull, bend): (f64, f64), (n, seen): (f64, View)| {
                (pull + n * (seen.factor * seen.along), bend + n * n * seen.bend)
            };
            let (pull, bend) = seen(s.0[0]).fold((0.0, 0.0), add);
            if search.step(0, pull, bend, &mut s) {
                break;
            }
        }
        let there: f64 = seen(s.0[0]).map(|(_, seen)| seen.square).sum();
        if there < best.0 {
            best = (there, Some(s.0[0]));
        }
    }
    best.1
}
