//! Non-local pose means of a stream.
//!
//! The distance of two patches is a sum of distances of single frames. A new frame is compared with the frames of one search
//! radius before it, once; the sums over the patches are taken anew for each frame, so that no error runs on.

use super::ends::{Ends, Window};
use super::pose::{Pose, Ring, plane, width};
use super::{MOST_NUMBERS, PoseStream};
use crate::filters::nonlocal_pose_means::{Chart, Distance, NonlocalPoseMeans, Reach, Weights};
use crate::rotations::quaternion::{between, exp_one, log_one, log_short, product, unit};
use crate::simd::multiversion;
use crate::{Error, Real};

/// Exponent of the floor of the self-weight, as in the filter of the whole clip.
const FLOOR: f64 = -80.0;

/// The exponent beyond which a candidate has no weight, as in the filter of the whole clip.
const FARTHEST: f64 = 120.0;

/// Factors of squares beyond it weigh nothing but equal rotations, and the products stay finite.
const LARGEST_FACTOR: f64 = 1e30;

/// Planes of a frame: its unit quaternions (local chart), or half rotation vectors and one to spare, and its confidences.
const PLANES: usize = 5;

impl NonlocalPoseMeans {
    /// The filter as a stream, over poses with a joint for each bandwidth.
    ///
    /// Of the chart, the boundary and the search radius only those will do that the first pose that comes out can know of.
    ///
    /// # Errors
    /// [`Error::Parameter`] for options that ask for the whole clip, or for too much memory.
    pub fn stream(&self) -> Result<PoseStream, Error> {
        let joints = self.bandwidth.len();
        let refused = |name, expected| Err(Error::Parameter { name, expected });
        if self.search_radius.is_none() {
            return refused("search_radius", "a number of frames");
        }
        if self.chart == Chart::Mean {
            return refused("chart", "a chart that does not depend on the whole clip");
        }
        let Some(window) = Means::new(self) else {
            return refused("search_radius", "a window whose patch distances fit into 2 GiB");
        };
        Ok(PoseStream::new(Ends::new(window, self.boundary, joints)?, joints))
    }
}

/// The latest frames, how far they are from each other, and the mean of one of them.
struct Means {
    reach: Reach,
    distance: Distance,
    weights: Weights,
    neighbors: Option<usize>,
    local: bool,
    joints: usize,
    /// `2/h²` per joint: half rotation vectors have a quarter of the squares.
    factors: Vec<f64>,
    frames: Ring<PLANES>,
    /// Per frame and for each lag: its distance from the frame so long before, and the share of confidence that entered it.
    pairs: Ring<2>,
    /// Distances of a pair per joint, and shares.
    terms: [Vec<f64>; 2],
    earlier: Candidates,
    later: Candidates,
    /// Distances of one column and places of candidates, the nearest in time first.
    sorted: Vec<(f64, usize)>,
    sums: Sums,
}

/// How far candidates are, or how much they weigh: for each lag a column per weight.
struct Candidates {
    exponents: Vec<f64>,
    shares: Vec<f64>,
}

impl Candidates {
    fn new(numbers: usize) -> Self {
        Self { exponents: vec![0.0; numbers], shares: vec![0.0; numbers] }
    }

    fn clear(&mut self) {
        self.exponents.fill(0.0);
        self.shares.fill(0.0);
    }

    /// Makes exponents of sums of distances; infinite where nothing entered.
    fn settle(&mut self, distance: Distance) {
        for (exponent, share) in self.exponents.iter_mut().zip(&self.shares) {
            let divisor = if distance == Distance::Mean { 3.0 * share } else { 1.0 };
            *exponent = if *share > 0.0 { *exponent / divisor } else { f64::INFINITY };
        }
    }
}

/// Sums over the candidates, planes over the joints.
struct Sums {
    weights: Vec<f64>,
    most: Vec<f64>,
    total: Vec<f64>,
    turn: [Vec<f64>; 3],
}

/// How many weights a candidate has.
fn columns(weights: Weights, width: usize) -> usize {
    if weights == Weights::Joint { width.max(1) } else { 1 }
}

impl Means {
    /// `None` if it would take too much memory.
    fn new(filter: &NonlocalPoseMeans) -> Option<Self> {
        let joints = filter.bandwidth.len();
        let width = width(joints);
        let reach = filter.reach(0);
        let columns = columns(filter.weights, width);
        let pairs = reach.back.checked_mul(columns)?;
        let latency = reach.ahead.checked_add(reach.after)?;
        let patches = latency.checked_add(reach.before + 1)?;
        let frames = latency.checked_add(reach.back + 1)?;
        let numbers = pairs.checked_mul(patches)?.checked_mul(2)?;
        let numbers = numbers.checked_add(frames.checked_mul(width)?.checked_mul(PLANES)?)?;
        (numbers <= MOST_NUMBERS).then_some(())?;
        let zeros = |length: usize| vec![0.0; length];
        Some(Self {
            reach,
            distance: filter.distance,
            weights: filter.weights,
            neighbors: filter.neighbors,
            local: filter.chart == Chart::Local,
            joints,
            factors: plane(filter.bandwidth.iter().map(|h| (2.0 / h / h).min(LARGEST_FACTOR))),
            frames: Ring::new(frames, width),
            pairs: Ring::new(patches, pairs),
            terms: [zeros(width), zeros(width)],
            earlier: Candidates::new(pairs),
            later: Candidates::new(reach.ahead * columns),
            sorted: Vec::with_capacity(reach.back + reach.ahead),
            sums: Sums {
                weights: zeros(width),
                most: zeros(width),
                total: zeros(width),
                turn: [zeros(width), zeros(width), zeros(width)],
            },
        })
    }

    fn columns(&self) -> usize {
        columns(self.weights, self.factors.len())
    }

    /// Sums the distances of frames over the patches of the frame that is filtered and of its candidates.
    fn compare(&mut self) {
        let Reach { ahead, before, after, .. } = self.reach;
        let columns = self.columns();
        let Self { pairs, earlier, later, .. } = self;
        earlier.clear();
        for ago in ahead..=ahead + after + before {
            let [distances, shares] = pairs.ago(ago);
            add(&mut earlier.exponents, distances);
            add(&mut earlier.shares, shares);
        }
        later.clear();
        let lags = later.exponents.chunks_exact_mut(columns).zip(later.shares.chunks_exact_mut(columns));
        for (lag, (exponents, sums)) in (1..).zip(lags) {
            let place = (lag - 1) * columns..lag * columns;
            for ago in ahead - lag..=ahead - lag + after + before {
                let [distances, shares] = pairs.ago(ago);
                add(exponents, &distances[place.clone()]);
                add(sums, &shares[place.clone()]);
            }
        }
        earlier.settle(self.distance);
        later.settle(self.distance);
    }

    /// Puts all but the most similar candidates infinitely far away.
    ///
    /// Of equal ones the nearer in time counts, then the earlier.
    fn keep(&mut self, count: usize) {
        let columns = self.columns();
        let Self { earlier, later, sorted, .. } = self;
        for column in 0..columns {
            sorted.clear();
            for (later, candidates) in [&*earlier, &*later].into_iter().enumerate() {
                let exponents = candidates.exponents.iter().skip(column).step_by(columns);
                sorted.extend(exponents.enumerate().map(|(lag, &exponent)| (exponent, 2 * lag + later)));
            }
            if count >= sorted.len() {
                return;
            }
            let rest = match count.checked_sub(1) {
                Some(last) => {
                    let order = |a: &(f64, usize), b: &(f64, usize)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
                    sorted.select_nth_unstable_by(last, order).2
                }
                None => &mut sorted[..],
            };
            for &(_, place) in &*rest {
                let candidates = if place % 2 == 0 { &mut *earlier } else { &mut *later };
                candidates.exponents[place / 2 * columns + column] = f64::INFINITY;
            }
        }
    }

    /// Sums the weights of candidates, and where they lie as seen from the frame that is filtered.
    fn sum(&mut self) {
        let Reach { ahead, after, .. } = self.reach;
        let columns = self.columns();
        let Self { frames, earlier, later, sums, local, .. } = self;
        let now = ahead + after;
        let Sums { weights, most, total, turn } = sums;
        for plane in [&mut *most, &mut *total].into_iter().chain(&mut *turn) {
            plane.fill(0.0);
        }
        let [a, b, c, d, _] = frames.ago(now);
        for (candidates, before) in [(earlier, true), (later, false)] {
            weigh(&mut candidates.exponents);
            for (lag, likeness) in (1..).zip(candidates.exponents.chunks_exact(columns)) {
                let [p, q, r, s, trust] = frames.ago(if before { now + lag } else { now - lag });
                if let [one] = *likeness {
                    weights.fill(one);
                } else {
                    weights.copy_from_slice(likeness);
                }
                note(weights, trust, most, total);
                if *local {
                    turn_to([a, b, c, d], [p, q, r, s], weights, turn.each_mut().map(|turn| &mut turn[..]));
                } else {
                    lead_to([a, b, c], [p, q, r], weights, turn.each_mut().map(|turn| &mut turn[..]));
                }
            }
        }
    }
}

impl Window for Means {
    fn reach(&self) -> (usize, usize) {
        let Reach { back, ahead, before, after, .. } = self.reach;
        (back + before, ahead + after)
    }

    fn admit(&mut self, pose: &Pose) {
        let [a, b, c, d, trust] = self.frames.advance();
        trust.copy_from_slice(pose.confidence());
        if self.local {
            for (plane, q) in [a, b, c, d].into_iter().zip(pose.rotations()) {
                plane.copy_from_slice(q);
            }
        } else {
            logs(pose.rotations(), [a, b, c]);
        }
        let columns = self.columns();
        let Self { frames, pairs, terms: [terms, shares], factors, local, joints, .. } = self;
        let [distances, entered] = pairs.advance();
        let [a, b, c, d, trust] = frames.ago(0);
        let lags = distances.chunks_exact_mut(columns).zip(entered.chunks_exact_mut(columns));
        for (lag, (distances, entered)) in (1..).zip(lags) {
            let [p, q, r, s, other] = frames.ago(lag);
            multiply(trust, other, shares);
            if *local {
                turn_terms([p, q, r, s], [a, b, c, d], factors, shares, terms);
            } else {
                lead_terms([p, q, r], [a, b, c], factors, shares, terms);
            }
            if let ([distance], [share]) = (&mut *distances, &mut *entered) {
                *distance = terms[..*joints].iter().sum();
                *share = shares[..*joints].iter().sum();
            } else {
                distances.copy_from_slice(terms);
                entered.copy_from_slice(shares);
            }
        }
    }

    fn settle(&mut self, out: &mut Pose) {
        self.compare();
        if let Some(count) = self.neighbors {
            self.keep(count);
        }
        self.sum();
        let Self { frames, sums: Sums { most, total, turn, .. }, local, .. } = self;
        let [a, b, c, d, trust] = frames.ago(self.reach.ahead + self.reach.after);
        add_own(most, Real::exp(FLOOR), trust, total);
        let turn = turn.each_ref().map(|turn| &turn[..]);
        if *local {
            move_from([a, b, c, d], turn, total, out.rotations_mut());
        } else {
            move_in_chart([a, b, c], turn, total, out.rotations_mut());
        }
    }

    fn appear(&mut self, joint: usize, q: [f64; 4]) {
        if self.local {
            self.frames.fill(0, joint, q);
        } else {
            self.frames.fill(0, joint, log_one(q));
        }
    }
}

multiversion! {
    /// `to += a`.
    fn add<T: Real>(to: &mut [T], a: &[T]) {
        let n = to.len();
        let a = &a[..n];
        for i in 0..n {
            to[i] += a[i];
        }
    }
}

multiversion! {
    /// `c = a·b`.
    fn multiply<T: Real>(a: &[T], b: &[T], c: &mut [T]) {
        let n = c.len();
        let (a, b) = (&a[..n], &b[..n]);
        for i in 0..n {
            c[i] = a[i] * b[i];
        }
    }
}

multiversion! {
    /// Half rotation vectors of unit quaternions; the sign matters.
    fn logs<T: Real>(q: [&[T]; 4], v: [&mut [T]; 3]) {
        let n = q[0].len();
        let q = q.map(|q| &q[..n]);
        let [x, y, z] = v.map(|v| &mut v[..n]);
        for i in 0..n {
            let one = log_one([q[0][i], q[1][i], q[2][i], q[3][i]]);
            x[i] = one[0];
            y[i] = one[1];
            z[i] = one[2];
        }
    }
}

multiversion! {
    /// `factor·share·‖v‖²` of the turns `v` from `q` to `r`.
    fn turn_terms<T: Real>(q: [&[T]; 4], r: [&[T]; 4], factors: &[T], shares: &[T], terms: &mut [T]) {
        let n = terms.len();
        let (q, r) = (q.map(|q| &q[..n]), r.map(|r| &r[..n]));
        let (factors, shares) = (&factors[..n], &shares[..n]);
        for i in 0..n {
            let v = log_short(between([q[0][i], q[1][i], q[2][i], q[3][i]], [r[0][i], r[1][i], r[2][i], r[3][i]]));
            terms[i] = factors[i] * shares[i] * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
        }
    }
}

multiversion! {
    /// `factor·share·‖v‖²` of the differences `v` from `x` to `y`.
    fn lead_terms<T: Real>(x: [&[T]; 3], y: [&[T]; 3], factors: &[T], shares: &[T], terms: &mut [T]) {
        let n = terms.len();
        let (x, y) = (x.map(|x| &x[..n]), y.map(|y| &y[..n]));
        let (factors, shares) = (&factors[..n], &shares[..n]);
        for i in 0..n {
            let (a, b, c) = (y[0][i] - x[0][i], y[1][i] - x[1][i], y[2][i] - x[2][i]);
            terms[i] = factors[i] * shares[i] * (a * a + b * b + c * c);
        }
    }
}

multiversion! {
    /// Exponents to weights; 0 beyond [`FARTHEST`].
    fn weigh<T: Real>(exponents: &mut [T]) {
        for e in exponents {
            let weight = (-*e).exp();
            *e = if *e <= T::from_f64(FARTHEST) { weight } else { T::ZERO };
        }
    }
}

multiversion! {
    /// Keeps the largest weight, and then adds the weights times their confidence to the total.
    fn note<T: Real>(weights: &mut [T], trust: &[T], most: &mut [T], total: &mut [T]) {
        let n = weights.len();
        let (trust, most, total) = (&trust[..n], &mut most[..n], &mut total[..n]);
        for i in 0..n {
            most[i] = most[i].max(weights[i]);
            weights[i] *= trust[i];
            total[i] += weights[i];
        }
    }
}

multiversion! {
    /// Adds the weighted turns from `q` to `r`.
    fn turn_to<T: Real>(q: [&[T]; 4], r: [&[T]; 4], weights: &[T], sums: [&mut [T]; 3]) {
        let n = weights.len();
        let (q, r) = (q.map(|q| &q[..n]), r.map(|r| &r[..n]));
        let [x, y, z] = sums.map(|sums| &mut sums[..n]);
        for i in 0..n {
            let v = log_short(between([q[0][i], q[1][i], q[2][i], q[3][i]], [r[0][i], r[1][i], r[2][i], r[3][i]]));
            x[i] += weights[i] * v[0];
            y[i] += weights[i] * v[1];
            z[i] += weights[i] * v[2];
        }
    }
}

multiversion! {
    /// Adds the weighted differences from `x` to `y`.
    fn lead_to<T: Real>(x: [&[T]; 3], y: [&[T]; 3], weights: &[T], sums: [&mut [T]; 3]) {
        let n = weights.len();
        for ((x, y), sums) in x.into_iter().zip(y).zip(sums) {
            let (x, y, sums) = (&x[..n], &y[..n], &mut sums[..n]);
            for i in 0..n {
                sums[i] += weights[i] * (y[i] - x[i]);
            }
        }
    }
}

multiversion! {
    /// Adds each frame's own weight, the largest of the others but at least `floor`, times its confidence.
    fn add_own<T: Real>(most: &[T], floor: T, trust: &[T], total: &mut [T]) {
        let n = total.len();
        let (most, trust) = (&most[..n], &trust[..n]);
        for i in 0..n {
            total[i] += most[i].max(floor) * trust[i];
        }
    }
}

multiversion! {
    /// `q·exp(sums / total)`; `q` where nothing has weight.
    fn move_from<T: Real>(q: [&[T]; 4], sums: [&[T]; 3], total: &[T], out: [&mut [T]; 4]) {
        let n = total.len();
        let (q, sums) = (q.map(|q| &q[..n]), sums.map(|sums| &sums[..n]));
        let [w, x, y, z] = out.map(|out| &mut out[..n]);
        for i in 0..n {
            let weight = if total[i] > T::ZERO { total[i] } else { T::ONE };
            let by = exp_one([sums[0][i] / weight, sums[1][i] / weight, sums[2][i] / weight]);
            let one = unit(product([q[0][i], q[1][i], q[2][i], q[3][i]], by));
            w[i] = one[0];
            x[i] = one[1];
            y[i] = one[2];
            z[i] = one[3];
        }
    }
}

multiversion! {
    /// `exp(v + sums / total)`; `exp v` where nothing has weight.
    fn move_in_chart<T: Real>(v: [&[T]; 3], sums: [&[T]; 3], total: &[T], out: [&mut [T]; 4]) {
        let n = total.len();
        let (v, sums) = (v.map(|v| &v[..n]), sums.map(|sums| &sums[..n]));
        let [w, x, y, z] = out.map(|out| &mut out[..n]);
        for i in 0..n {
            let weight = if total[i] > T::ZERO { total[i] } else { T::ONE };
            let at = [v[0][i] + sums[0][i] / weight, v[1][i] + sums[1][i] / weight, v[2][i] + sums[2][i] / weight];
            let one = unit(exp_one(at));
            w[i] = one[0];
            x[i] = one[1];
            y[i] = one[2];
            z[i] = one[3];
        }
    }
}
