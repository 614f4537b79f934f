//! A motion that follows control points, frame by frame.

mod poses;
mod search;
mod sight;
mod within;

pub use poses::Poses;

use super::frame::{HORIZONTAL, heading, turn, turned};
use super::kinematics::{Base, Body, WAY};
use super::local_models::{self, Neighbors, predict_pose};
use super::solver::{Prior, Solver, Targets};
use crate::Error;
use crate::error::check_length;
use crate::parallel::Interrupt;
use crate::rotations::quaternion::{between, log_short, of_row, product};
use search::Query;
use sight::Sight;
use std::collections::VecDeque;
use within::within;

/// How a motion is reconstructed.
#[derive(Debug, Clone)]
pub struct Options {
    /// How many poses before are compared, and predicted from.
    pub order: usize,
    /// How many examples are learned from.
    pub neighbors: usize,
    /// Every which pose of a clip may be an example.
    pub stride: usize,
    /// So many frames apart are examples of one clip, at least.
    pub spacing: usize,
    /// How many frames ago control points are compared.
    pub window: Vec<usize>,
    /// Distance of control points that counts as much as a radian between poses; infinite: poses alone.
    pub scale: f64,
    /// After so many frames without a control point the next one is a new start.
    pub patience: usize,
    /// How examples predict.
    pub model: local_models::Options,
    /// Standard deviations of what models do not see: of a joint's coordinate in radians, and of the root's way.
    pub floor: [f64; 1 + WAY],
    /// The most steps of the solver per frame.
    pub steps: usize,
}

/// What is known of the frames before.
#[derive(Debug, Clone)]
pub struct State {
    /// The last poses, `(order, joints, 4)`, the oldest first, without headings.
    pub recent: Vec<f64>,
    /// Where the root was in the last frame.
    pub place: [f64; 3],
    /// Its heading then, radians.
    pub heading: f64,
}

/// The most probable pose of a frame.
#[derive(Debug, Clone)]
pub struct Pose {
    /// Rotations, `(joints, 4)`.
    pub rotations: Vec<f64>,
    /// Position of the root.
    pub translation: [f64; 3],
    /// The two parts of the energy: of what is seen, and of what was expected.
    pub energies: [f64; 2],
}

/// Takes control points frame by frame, and gives poses.
#[derive(Debug, Clone)]
pub struct Tracker {
    solver: Solver,
    options: Options,
    state: Option<State>,
    /// Control points of the last frames and their weights, the newest first.
    past: VecDeque<(Vec<f64>, Vec<f64>)>,
    /// Frames since a control point was seen.
    blind: usize,
    sight: Sight,
    features: Vec<Vec<f64>>,
}

impl Tracker {
    /// A tracker of one body; without a state it starts from the pose of the database that fits the first frame best.
    ///
    /// # Errors
    /// [`Error::Length`] and [`Error::Parameter`] if options and state are not of the body.
    pub fn new(body: Body, options: Options, state: Option<State>) -> Result<Self, Error> {
        if options.order == 0 || options.neighbors == 0 || !options.window.contains(&0) {
            return Err(Error::Parameter { name: "options", expected: "an order, neighbors, and a window" });
        }
        if let Some(state) = &state {
            check_length("initial", 4 * options.order * body.joints(), state.recent.len())?;
        }
        Ok(Self {
            solver: Solver::new(body),
            features: vec![Vec::new(); options.order],
            options,
            state,
            past: VecDeque::new(),
            blind: 0,
            sight: Sight::default(),
        })
    }

    /// How many poses of its clip an example has before it.
    fn before(&self) -> usize {
        self.options.window.iter().copied().max().unwrap_or(0).max(self.options.order)
    }

    /// Takes in the control points of the next frame, and returns its pose.
    ///
    /// In each frame, the examples nearest to the last poses are found, a local model of how they went on predicts the pose,
    /// and the most probable pose is found from the prediction or from the nearest example, whichever has the lower energy.
    ///
    /// # Errors
    /// [`Error::Length`] and [`Error::Parameter`] if the database or the targets are not of the body, or the database has no
    /// clip that is long enough; [`Error::Interrupted`]. The tracker then is as it was.
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
        self.sight.clear();
        for &lag in &self.options.window {
            if lag == 0 {
                self.sight.add(0, seen.positions, &weights, up);
            } else if let Some((positions, weights)) = self.past.get(lag - 1) {
                self.sight.add(lag, positions, weights, up);
            }
        }
        self.sight.finish();
        let lost = self.blind >= self.options.patience && !missing;
        let state = match &self.state {
            Some(state) if !lost => state.clone(),
            _ => self.begin(poses, interrupt)?,
        };
        let pose = self.next(poses, &state, seen, interrupt)?;
        self.state = Some(follow(state, &pose, up));
        self.blind = if missing { self.blind + 1 } else { 0 };
        self.past.push_front((seen.positions.to_vec(), weights));
        self.past.truncate(self.before());
        Ok(pose)
    }

    /// What came before, from the pose that fits the control points best, where it fits best.
    fn begin(&self, poses: &Poses<'_>, interrupt: &Interrupt) -> Result<State, Error> {
        let up = self.solver.body().up;
        let [first, second] = HORIZONTAL[up];
        let query = self.query(poses, &[]);
        let Some((best, fit)) = query.best_fit(interrupt)? else {
            return Err(Error::Parameter { name: "poses", expected: "a clip longer than the window" });
        };
        let last = best - 1;
        let (angle, shift) = self.sight.laid(&fit);
        let there = poses.place(last);
        let mut place = turned([there[first], there[second]], angle, up);
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

    fn query<'a>(&'a self, poses: &Poses<'a>, features: &'a [Vec<f64>]) -> Query<'a> {
        Query {
            poses: *poses,
            features,
            sight: &self.sight,
            points: self.solver.body().points(),
            up: self.solver.body().up,
            before: self.before(),
            stride: self.options.stride.max(1),
            scale: self.options.scale,
        }
    }

    fn next(
        &mut self,
        poses: &Poses<'_>,
        state: &State,
        seen: &Targets<'_>,
        interrupt: &Interrupt,
    ) -> Result<Pose, Error> {
        let (joints, up) = (self.solver.body().joints(), self.solver.body().up);
        let order = self.options.order;
        let mut features = std::mem::take(&mut self.features);
        for (feature, pose) in features.iter_mut().zip(state.recent.chunks_exact(4 * joints).rev()) {
            poses.feature(pose, feature);
        }
        let found =
            self.query(poses, &features).nearest(self.options.neighbors, self.options.spacing, interrupt);
        self.features = features;
        let found = found?;
        let mut segments = Vec::with_capacity(found.len() * (order + 1) * joints * 4);
        let mut root_steps = Vec::with_capacity(found.len() * WAY);
        for &example in &found {
            segments.extend(poses.segment(example - order..example + 1).iter().copied().map(f64::from));
            root_steps.extend(poses.way(example, up));
        }
        let neighbors = Neighbors {
            segments: &segments,
            root_steps: &root_steps,
            count: found.len(),
            frames: order + 1,
            joints,
            roots: WAY,
        };
        let query = within(&segments, &state.recent, poses.joint_weights);
        let mut prediction =
            predict_pose(&neighbors, &query, poses.joint_weights, &self.options.model, interrupt)?;
        for (d, deviation) in prediction.deviation.iter_mut().enumerate() {
            let floor = self.options.floor[(d + 1).saturating_sub(3 * joints)];
            *deviation = (*deviation * *deviation + floor * floor).sqrt();
        }
        let mut example: Vec<f64> = Vec::with_capacity(3 * joints + WAY);
        let nearest = &segments[4 * order * joints..4 * (order + 1) * joints];
        for (q, &centre) in nearest.chunks_exact(4).zip(&prediction.chart) {
            example.extend(log_short(between(centre, of_row(q))).map(|v| 2.0 * v));
        }
        example.extend(&root_steps[..WAY]);
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

/// What is known after one more frame.
fn follow(state: State, pose: &Pose, up: usize) -> State {
    let width = pose.rotations.len();
    let angle = heading(of_row(&pose.rotations), up);
    let mut recent = state.recent;
    recent.drain(..width);
    recent.extend(product(turn(-angle, up), of_row(&pose.rotations)));
    recent.extend(&pose.rotations[4..]);
    State { recent, place: pose.translation, heading: angle }
}
