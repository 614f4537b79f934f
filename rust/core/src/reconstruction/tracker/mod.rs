//! Frame-by-frame reconstruction of a motion from control points.

mod lattice;
mod observations;
mod poses;
mod recent;
mod search;
mod shrink;
mod signals;
mod tables;
mod trajectories;
mod walk;

pub use poses::Poses;
pub use tables::Tables;

use super::frame::{HORIZONTAL, heading, rotated, rotation_about};
use super::kinematics::{Base, Body, ROOT};
use super::local_models::{self, Neighbors, predict_pose};
use super::solver::{Prior, Solver, Targets};
use crate::Error;
use crate::error::check_length;
use crate::parallel::Interrupt;
use crate::rotations::quaternion::{between, log_short, of_row, product};
use crate::search::poses::walk::Fallback;
use lattice::Lattice;
use observations::Observations;
use recent::Recent;
use search::{Example, Query};
use shrink::shrunk;
use signals::Signals;
use std::collections::VecDeque;
use std::sync::Arc;
use tables::Shape;
use trajectories::Trajectories;
use walk::Walk;

/// Options of a reconstruction.
#[derive(Debug, Clone)]
pub struct Options {
    /// Number of previous poses that are compared and that the prediction uses.
    pub order: usize,
    /// Number of examples.
    pub neighbors: usize,
    /// Only every `stride`-th pose of a clip is a candidate.
    pub stride: usize,
    /// Minimum distance between two examples of one clip, in frames.
    pub spacing: usize,
    /// Lags, in frames, at which control points are compared.
    pub window: Vec<usize>,
    /// Distance of control points that counts as much as one radian between poses, in the search for examples and in
    /// the regression; infinite: only poses count.
    pub scale: f64,
    /// Number of frames without any control point after which the tracker restarts.
    pub patience: usize,
    /// The local model.
    pub model: local_models::Options,
    /// Standard deviations added to those of the model: of a joint's coordinate in radians, and of the root's
    /// displacement.
    pub floor: [f64; 1 + ROOT],
    /// Largest number of solver steps per frame.
    pub steps: usize,
    /// With a graph: when the tracker falls back to a full search.
    pub fallback: Fallback,
}

/// State after the previous frame.
#[derive(Debug, Clone)]
pub struct State {
    /// The last poses, `(order, joints, 4)`, the oldest first, without headings.
    pub recent: Vec<f64>,
    /// Position of the root in the last frame.
    pub place: [f64; 3],
    /// Heading of the root in the last frame, radians.
    pub heading: f64,
}

/// The most probable pose of a frame.
#[derive(Debug, Clone)]
pub struct Pose {
    /// Rotations, `(joints, 4)`.
    pub rotations: Vec<f64>,
    /// Position of the root.
    pub translation: [f64; 3],
    /// The two terms of the energy: of the observations and of the prior.
    pub energies: [f64; 2],
}

/// Reconstructs poses from control points, frame by frame.
#[derive(Debug, Clone)]
pub struct Tracker {
    solver: Solver,
    options: Options,
    state: Option<State>,
    /// Control points of the last frames and their weights, the newest first.
    past: VecDeque<(Vec<f64>, Vec<f64>)>,
    /// Number of frames since a control point was observed.
    blind: usize,
    observations: Observations,
    /// Tables that do not depend on the frame.
    tables: Arc<Tables>,
    walk: Walk,
    /// Bit set over all poses of the database.
    bits: Vec<u64>,
}

impl Tracker {
    /// A tracker of one body. Without a state it starts from the pose of the database that fits the first frame best.
    /// Trackers of the same body, options and poses may share their `tables`, which are empty at first.
    ///
    /// # Errors
    /// [`Error::Length`] and [`Error::Parameter`] if options and state do not match the body.
    pub fn new(
        body: Body,
        options: Options,
        state: Option<State>,
        tables: Arc<Tables>,
    ) -> Result<Self, Error> {
        if options.order == 0 || options.neighbors == 0 || !options.window.contains(&0) {
            return Err(Error::Parameter { name: "options", expected: "an order, neighbors, and a window" });
        }
        if let Some(state) = &state {
            check_length("initial", 4 * options.order * body.joints(), state.recent.len())?;
        }
        Ok(Self {
            solver: Solver::new(body),
            options,
            state,
            past: VecDeque::new(),
            blind: 0,
            observations: Observations::default(),
            tables,
            walk: Walk::default(),
            bits: Vec::new(),
        })
    }

    /// Number of poses of its clip that an example needs before it.
    fn before(&self) -> usize {
        self.options.window.iter().copied().max().unwrap_or(0).max(self.options.order)
    }

    /// Takes the control points of the next frame, and returns its pose.
    ///
    /// The poses must be the same in each frame. Each frame takes three steps: search the examples nearest to the
    /// last poses; predict the pose by a local model of the examples; minimise the energy, starting from the
    /// prediction or from the nearest example, whichever has the lower energy.
    ///
    /// # Errors
    /// [`Error::Length`] and [`Error::Parameter`] if the database or the targets do not match the body, or no clip of
    /// the database is long enough; [`Error::Interrupted`]. The tracker is then unchanged.
    pub fn push(
        &mut self,
        poses: &Poses<'_>,
        seen: &Targets<'_>,
        interrupt: &Interrupt,
    ) -> Result<Pose, Error> {
        let (points, up) = (self.solver.body().points(), self.solver.body().up);
        poses.check(self.solver.body().joints(), points)?;
        seen.check(points)?;
        let weights: Vec<f64> = (seen.position_deviations.iter())
            .map(|&deviation| if deviation.is_finite() { 1.0 / (deviation * deviation) } else { 0.0 })
            .collect();
        let missing = weights.iter().all(|&weight| weight == 0.0);
        self.observations.clear();
        for (slot, &lag) in self.options.window.iter().enumerate() {
            if lag == 0 {
                self.observations.add((slot, 0), seen.positions, &weights, up);
            } else if let Some((positions, weights)) = self.past.get(lag - 1) {
                self.observations.add((slot, lag), positions, weights, up);
            }
        }
        self.observations.finish();
        let tables = Arc::clone(&self.tables);
        let shape = Shape {
            before: self.before(),
            stride: self.options.stride.max(1),
            window: &self.options.window,
            points,
            up,
        };
        let candidates = tables.of(poses, shape)?;
        let (pose, state, walk) = self.reach(poses, candidates, seen, missing, interrupt)?;
        self.walk = walk;
        self.state = Some(follow(state, &pose, up));
        self.blind = if missing { self.blind + 1 } else { 0 };
        self.past.push_front((seen.positions.to_vec(), weights));
        self.past.truncate(self.before());
        Ok(pose)
    }

    /// The pose of the next frame, the state from which it was computed, and the updated walk.
    fn reach(
        &mut self,
        poses: &Poses<'_>,
        candidates: &(Lattice, Trajectories),
        seen: &Targets<'_>,
        missing: bool,
        interrupt: &Interrupt,
    ) -> Result<(Pose, State, Walk), Error> {
        let lost = self.blind >= self.options.patience && !missing;
        let (state, walk) = match &self.state {
            Some(state) if !lost => (state.clone(), self.walk.clone()),
            _ => (self.begin(&self.query(poses, candidates), interrupt)?, Walk::default()),
        };
        let (found, walk) = self.examples(poses, candidates, &state, &walk, interrupt)?;
        let pose = self.next(poses, &found, &state, seen, interrupt)?;
        Ok((pose, state, walk))
    }

    /// Initial state: the poses before the best-fitting pose of the database, moved to the best fit.
    fn begin(&self, query: &Query<'_>, interrupt: &Interrupt) -> Result<State, Error> {
        let up = self.solver.body().up;
        let [first, second] = HORIZONTAL[up];
        let poses = &query.poses;
        let Some((best, fit)) = query.best_fit(interrupt)? else {
            return Err(Error::Parameter { name: "poses", expected: "a clip longer than the window" });
        };
        let last = best - 1;
        let (angle, shift) = self.observations.transform(&fit);
        let there = poses.place(last);
        let mut place = rotated([there[first], there[second]], angle, up);
        place[first] += shift[0];
        place[second] += shift[1];
        place[up] = there[up];
        let recent = poses.segment(last + 1 - self.options.order..last + 1);
        Ok(State {
            recent: recent.iter().copied().map(f64::from).collect(),
            place,
            heading: f64::from(poses.heading[last]) + angle,
        })
    }

    fn query<'a>(&'a self, poses: &Poses<'a>, candidates: &'a (Lattice, Trajectories)) -> Query<'a> {
        Query {
            poses: *poses,
            lattice: &candidates.0,
            trajectories: &candidates.1,
            observations: &self.observations,
            up: self.solver.body().up,
            scale: self.options.scale,
            count: self.options.neighbors,
            spacing: self.options.spacing,
        }
    }

    /// The examples of a frame: along the graph if there is one and its result is near enough, else by a full search.
    fn examples(
        &mut self,
        poses: &Poses<'_>,
        candidates: &(Lattice, Trajectories),
        state: &State,
        walk: &Walk,
        interrupt: &Interrupt,
    ) -> Result<(Vec<Example>, Walk), Error> {
        let width = 4 * self.solver.body().joints();
        let mut features = Vec::with_capacity(state.recent.len());
        for pose in state.recent.chunks_exact(width) {
            poses.feature(pose, &mut features);
        }
        let recent = Recent::new(features, self.options.order);
        let fallback = self.options.fallback;
        if let Some(graph) = poses.graph.filter(|_| walk.goes_on(fallback)) {
            let around = walk.around(&candidates.0, graph, &mut self.bits);
            let found = self.query(poses, candidates).among(&recent, &around);
            if walk.keeps(&found, self.options.neighbors, fallback) {
                let walk = walk.follow(&found, false);
                return Ok((found, walk));
            }
        }
        let near = walk.near(&candidates.0);
        let found = self.query(poses, candidates).among_all(&recent, &near, interrupt)?;
        let walk = walk.follow(&found, true);
        Ok((found, walk))
    }

    fn next(
        &mut self,
        poses: &Poses<'_>,
        found: &[Example],
        state: &State,
        seen: &Targets<'_>,
        interrupt: &Interrupt,
    ) -> Result<Pose, Error> {
        let (joints, up) = (self.solver.body().joints(), self.solver.body().up);
        let order = self.options.order;
        let mut segments = Vec::with_capacity(found.len() * (order + 1) * joints * 4);
        let points = self.solver.body().points();
        let signals =
            Signals::new(poses, (points, up), found, &self.observations, (state, order), self.options.scale);
        for example in found.iter().map(|found| found.pose) {
            segments.extend(poses.segment(example - order..example + 1).iter().copied().map(f64::from));
        }
        let neighbors = Neighbors {
            segments: &segments,
            root_steps: &signals.root_steps,
            differences: &signals.differences,
            count: found.len(),
            frames: order + 1,
            joints,
            roots: ROOT,
            signals: signals.count,
        };
        let query = shrunk(&segments, &state.recent, poses.joint_weights);
        let mut prediction =
            predict_pose(&neighbors, &query, poses.joint_weights, &self.options.model, interrupt)?;
        for (d, deviation) in prediction.deviation.iter_mut().enumerate() {
            let floor = self.options.floor[(d + 1).saturating_sub(3 * joints)];
            *deviation = (*deviation * *deviation + floor * floor).sqrt();
        }
        let mut example: Vec<f64> = Vec::with_capacity(3 * joints + ROOT);
        let nearest = &segments[4 * order * joints..4 * (order + 1) * joints];
        for (q, &centre) in nearest.chunks_exact(4).zip(&prediction.chart) {
            example.extend(log_short(between(centre, of_row(q))).map(|v| 2.0 * v));
        }
        example.extend(&signals.root_steps[..ROOT]);
        let base = Base {
            centres: prediction.chart.as_flattened().to_vec(),
            place: state.place,
            heading: state.heading,
        };
        let prior =
            Prior { mean: &prediction.mean, deviation: &prediction.deviation, axes: &prediction.axes };
        let from_mean = self.solver.energy(&base, &prior, seen, &prediction.mean)?;
        let from_example = self.solver.energy(&base, &prior, seen, &example)?;
        let mut x = if from_example < from_mean { example } else { prediction.mean.clone() };
        let solution = self.solver.solve(&base, &prior, seen, &mut x, self.options.steps)?;
        let mut rotations = vec![0.0; 4 * joints];
        let translation = base.pose(&x, up, &mut rotations);
        Ok(Pose { rotations, translation, energies: [solution.likelihood, solution.prior] })
    }
}

/// The state after one more frame.
fn follow(state: State, pose: &Pose, up: usize) -> State {
    let width = pose.rotations.len();
    let angle = heading(of_row(&pose.rotations), up);
    let mut recent = state.recent;
    recent.drain(..width);
    recent.extend(product(rotation_about(-angle, up), of_row(&pose.rotations)));
    recent.extend(&pose.rotations[4..]);
    State { recent, place: pose.translation, heading: angle }
}
