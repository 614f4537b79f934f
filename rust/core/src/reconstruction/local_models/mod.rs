//! Local models: predict the next pose from the previous ones by a model of the nearest examples.
//!
//! Poses are rotation vectors in radians in a chart at the examples' mean. A pose of J joints with R coordinates of
//! the root has `D = 3J + R` outputs. With K examples of m poses each, every model needs only the `K × K` inner
//! products of the inputs.

mod chart;
mod dense;
mod deviations;
mod eigen;
mod examples;
mod principal;
mod regression;

use crate::error::check_length;
use crate::parallel::Interrupt;
use crate::{Error, Real};
use dense::Matrix;
pub use deviations::{LEAST_DEVIATION, UNKNOWN_DEVIATION};
use examples::Examples;

/// Examples that one vector operation handles; rows are padded to a multiple.
const LANE: usize = 16;

/// Model that predicts the next pose.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Model {
    /// Regression along one direction for each output: that of least squares (Mousas, Newbury and Anagnostopoulos
    /// 2014).
    LocalRegression,
    /// The same along the direction of partial least squares.
    PartialLeastSquares,
    /// Regression on the principal components of the inputs (Liu et al. 2011).
    LocalPcr,
    /// Mean and principal subspace of the next poses (Chai and Hodgins 2005).
    LocalPca,
    /// The next pose of the nearest example.
    Nearest,
    /// The weighted mean of the next poses.
    MeanPose,
}

/// Quantity that is predicted for the rotations.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Target {
    /// The rotation vectors of the next pose.
    Pose,
    /// Their changes from the last pose.
    Change,
}

/// Estimate of the standard deviations of regressions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Deviation {
    /// Leave-one-out residuals scaled to the query: they grow with its distance from the span of the examples.
    Predictive,
    /// Leave-one-out residuals.
    LeaveOneOut,
}

/// Parameters of a local model.
#[derive(Debug, Clone, Copy)]
pub struct Options {
    /// The model.
    pub model: Model,
    /// The quantity that it predicts.
    pub target: Target,
    /// The estimate of its standard deviations.
    pub deviation: Deviation,
    /// Width of the Gaussian weights of the examples, radians; 0 for the median of their distances.
    pub bandwidth: f64,
    /// Ridge, relative to the mean eigenvalue of the inputs' inner products.
    pub ridge: f64,
    /// Share of the variance that the principal components explain.
    pub share: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            model: Model::LocalRegression,
            target: Target::Pose,
            deviation: Deviation::Predictive,
            bandwidth: 0.0,
            ridge: 0.01,
            share: 0.99,
        }
    }
}

/// Examples: short segments of motion and the poses that follow them.
///
/// They should have a minimum distance in time: the nearest frames of a database are neighbours in a few clips and
/// carry the same information. Of examples that begin at every eighth frame at 60 frames per second, the nearest 64
/// halve the error of regressions.
#[derive(Debug, Clone, Copy)]
pub struct Neighbors<'a, T> {
    /// `(count, frames, joints, 4)`: poses, the oldest first; the last one is the pose to be predicted. No sample is
    /// missing.
    pub segments: &'a [T],
    /// `(count, roots)`: further outputs, of the root.
    pub root_steps: &'a [T],
    /// `(count, signals)`: further inputs, in radians or in units that count like radians: differences from the
    /// query, whose own are 0.
    pub differences: &'a [T],
    /// K.
    pub count: usize,
    /// m + 1.
    pub frames: usize,
    /// J.
    pub joints: usize,
    /// R.
    pub roots: usize,
    /// S.
    pub signals: usize,
}

/// The predicted pose and its Gaussian distribution.
#[derive(Debug, Clone)]
pub struct Prediction {
    /// Centres of the rotation vectors, `(joints)`.
    pub chart: Vec<[f64; 4]>,
    /// `(3·joints + roots)`: joint j is `chart_j · exp(mean_j / 2)`; then the outputs of the root.
    pub mean: Vec<f64>,
    /// Standard deviations apart from the axes, at least [`LEAST_DEVIATION`].
    pub deviation: Vec<f64>,
    /// `(3·joints + roots, rank)`: the covariance is `diag(deviation²) + axes axesᵀ`.
    pub axes: Vec<f64>,
    /// Number of axes; 0 except for [`Model::LocalPca`].
    pub rank: usize,
}

/// Predicts the pose that follows `recent`, `(frames − 1, joints, 4)`; `joint_weights` is the diagonal of W, by joint.
///
/// # Errors
/// [`Error::Length`] if the lengths of slices do not agree; [`Error::Parameter`] without an example, a previous pose
/// or a joint; [`Error::Interrupted`].
pub fn predict_pose<T: Real>(
    neighbors: &Neighbors<'_, T>,
    recent: &[T],
    joint_weights: &[f64],
    options: &Options,
    interrupt: &Interrupt,
) -> Result<Prediction, Error> {
    let &Neighbors { segments, root_steps, differences, count, frames, joints, roots, signals } = neighbors;
    if count == 0 || frames < 2 || joints == 0 {
        return Err(Error::Parameter { name: "segments", expected: "examples of two poses of some joints" });
    }
    check_length("segments", count * frames * joints * 4, segments.len())?;
    check_length("root_steps", count * roots, root_steps.len())?;
    check_length("differences", count * signals, differences.len())?;
    check_length("recent", (frames - 1) * joints * 4, recent.len())?;
    check_length("joint_weights", joints, joint_weights.len())?;
    let (chart, mut inputs, mut outputs) =
        chart::vectors(segments, (count, frames, joints), [signals, roots]);
    let mut query = chart::of_poses(recent, &chart);
    let change = options.target == Target::Change;
    let numbers = joints * 3;
    let mut last = vec![0.0; numbers + roots];
    if change {
        last[..numbers].copy_from_slice(&query[query.len() - numbers..]);
    }
    for (root, row) in outputs.rows_mut().skip(numbers).enumerate() {
        for (x, steps) in row.iter_mut().zip(root_steps.chunks_exact(roots)) {
            *x = steps[root].to_f64();
        }
    }
    for (signal, row) in inputs.rows_mut().skip(query.len()).enumerate() {
        for (x, differences) in row.iter_mut().zip(differences.chunks_exact(signals)) {
            *x = differences[signal].to_f64();
        }
    }
    if change {
        let before = inputs.rows().skip(query.len() - numbers).take(numbers);
        for (row, before) in outputs.rows_mut().zip(before) {
            for (x, before) in row.iter_mut().zip(before) {
                *x -= before;
            }
        }
    }
    let mut scale: Vec<f64> = (0..query.len()).map(|number| joint_weights[number / 3 % joints]).collect();
    query.resize(query.len() + signals, 0.0);
    scale.resize(query.len(), 1.0);
    let examples = Examples::gather(inputs, outputs, query, &scale, options);
    let (mut mean, mut deviation, axes, rank) = predicted(&examples, options, interrupt)?;
    for (x, last) in mean.iter_mut().zip(&last) {
        *x += last;
    }
    for x in &mut deviation {
        *x = x.max(LEAST_DEVIATION);
    }
    Ok(Prediction { chart, mean, deviation, axes, rank })
}

/// Mean, standard deviations, axes and number of axes of the outputs.
type Predicted = (Vec<f64>, Vec<f64>, Vec<f64>, usize);

fn predicted(examples: &Examples, options: &Options, interrupt: &Interrupt) -> Result<Predicted, Error> {
    let mean = examples.output_mean.clone();
    if examples.alone() {
        let deviation = vec![UNKNOWN_DEVIATION; mean.len()];
        return Ok((mean, deviation, Vec::new(), 0));
    }
    let fit = match options.model {
        Model::LocalPca => {
            let (deviation, axes, rank) = principal::analysis(examples, options.share, interrupt)?;
            return Ok((mean, deviation, axes, rank));
        }
        Model::MeanPose => {
            let deviation = deviations::Residuals(examples.outputs.copy()).left_out(examples);
            return Ok((mean, deviation, Vec::new(), 0));
        }
        Model::Nearest => return Ok(nearest(examples)),
        Model::LocalPcr => {
            let fit = principal::regression(examples, options.share, interrupt)?;
            fit.finish(options.deviation, examples, &examples.solve(interrupt)?)
        }
        Model::LocalRegression | Model::PartialLeastSquares => {
            let ridge = examples.solve(interrupt)?;
            let least_squares = options.model == Model::LocalRegression;
            let fit = regression::regression(examples, &ridge, least_squares);
            fit.finish(options.deviation, examples, &ridge)
        }
    };
    Ok((fit.0, fit.1, Vec::new(), 0))
}

/// The outputs of the nearest example, and the deviations of the others from them.
fn nearest(examples: &Examples) -> Predicted {
    let mut from_it = Matrix::new(examples.output_mean.len(), examples.count());
    let mut mean = Vec::with_capacity(examples.output_mean.len());
    for ((row, y), centre) in from_it.rows_mut().zip(examples.outputs.rows()).zip(&examples.output_mean) {
        let here = y[examples.nearest];
        mean.push(centre + here);
        for ((x, y), root) in row.iter_mut().zip(y).zip(&examples.roots) {
            *x = y - root * here;
        }
    }
    let deviation = deviations::Residuals(from_it).left_out(examples);
    (mean, deviation, Vec::new(), 0)
}
