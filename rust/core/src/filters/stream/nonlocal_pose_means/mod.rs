//! Non-local pose means of a stream.
//!
//! The distance of two patches is a sum of frame distances. A new frame is compared once with the frames within the
//! search radius before it. The sums over the patches are recomputed for each frame, so rounding errors do not
//! accumulate.
//!
//! - here: the window, and the distances of a new frame from the previous ones;
//! - `candidates`: patch distances, and the most similar patches;
//! - `sums`: weighted sums, and back to quaternions;
//! - `kernels`: the vectorised loops.

mod candidates;
mod kernels;
mod sums;

use super::ends::{Ends, Window};
use super::pose::{Pose, Ring, plane, width};
use super::{MOST_NUMBERS, PoseStream};
use crate::Error;
use crate::filters::nonlocal_pose_means::{Chart, Distance, NonlocalPoseMeans, Reach, Weights};
use crate::rotations::quaternion::log_one;
use candidates::{Candidates, columns};
use kernels::{lead_terms, logs, multiply, turn_terms};
use sums::Sums;

/// Largest factor of squares: with it only equal rotations have weights, and the products stay finite.
const LARGEST_FACTOR: f64 = 1e30;

/// Planes of a frame: its unit quaternions (local chart), or half rotation vectors and one unused plane; then its
/// confidences.
const PLANES: usize = 5;

impl NonlocalPoseMeans {
    /// The filter as a stream, over poses with one joint per bandwidth.
    ///
    /// Chart, boundary and search radius must be computable when the first result is due.
    ///
    /// # Errors
    /// [`Error::Parameter`] for options that require the whole clip, and for too much memory.
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

/// The latest frames, their distances, and the mean of one of them.
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
    /// Per frame and for each lag: its distance from the frame that long before, and the sum of confidence weights in
    /// it.
    pairs: Ring<2>,
    /// Distances of a pair per joint, and weights.
    terms: [Vec<f64>; 2],
    earlier: Candidates,
    later: Candidates,
    /// Distances of one column and indices of candidates, the nearest in time first.
    sorted: Vec<(f64, usize)>,
    sums: Sums,
}

impl Means {
    /// `None` if the memory is too large.
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
            sums: Sums::new(width),
        })
    }

    fn columns(&self) -> usize {
        columns(self.weights, self.factors.len())
    }
}

impl Window for Means {
    fn reach(&self) -> (usize, usize) {
        let Reach { back, ahead, before, after, .. } = self.reach;
        (back + before, ahead + after)
    }

    fn admit(&mut self, pose: &Pose) {
        let [a, b, c, d, confidence] = self.frames.advance();
        confidence.copy_from_slice(pose.confidence());
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
        let [a, b, c, d, confidence] = frames.ago(0);
        let lags = distances.chunks_exact_mut(columns).zip(entered.chunks_exact_mut(columns));
        for (lag, (distances, entered)) in (1..).zip(lags) {
            let [p, q, r, s, other] = frames.ago(lag);
            multiply(confidence, other, shares);
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
        self.mean(out);
    }

    fn appear(&mut self, joint: usize, q: [f64; 4]) {
        if self.local {
            self.frames.fill(0, joint, q);
        } else {
            self.frames.fill(0, joint, log_one(q));
        }
    }
}
