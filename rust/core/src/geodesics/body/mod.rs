//! Principal geodesic analysis of whole poses: geodesics of the product of all joints' rotations.
//!
//! The distance of two poses is `√(Σ_j d_j²)`. The geodesic with the direction `v`, a unit vector of `R^{3J}`, is
//! `c_v(s) = (exp(s v_1), …, exp(s v_J))`. It ends where its fastest joint has rotated by 180°: a longer one would
//! pass near all poses. The first direction minimises the distance of the geodesic through the means to the poses.
//! The next is fitted to the residuals `c_v(s)⁻¹ x`, joint by joint, and so on.

mod descent;
mod distance;
mod nearest;
mod objective;
mod poses;
mod projection;
mod scores;

pub use scores::{body_product, body_scores};

use super::pga::{Objective, Params, nearest_of_joint};
use crate::error::check_length;
use crate::parallel::{self, Interrupt};
use crate::rotations::quaternion::is_missing;
use crate::{ClipView, Error, Real};
use descent::{Found, Ground};
use objective::SAMPLE_NANOSECONDS;
use poses::{Lane, Poses, TILE, Tile, parts, take_away};
use projection::nearest_points;

/// Radians on S³: if all residuals are smaller, they are rounding errors and have no direction.
const NOTHING_LEFT: f64 = 1e-14;

/// A pose determines the sign of a direction if its parameter exceeds this fraction of the largest. Evenly spaced
/// poses of a swing never have exactly this fraction, so rounding does not decide.
const DECISIVE: f64 = 0.7;

/// A geodesic of whole poses.
#[derive(Debug, Clone)]
pub struct Component {
    /// Unit vector, three numbers for each joint. The first pose whose parameter is at least 0.7 of the largest has a
    /// positive one.
    pub direction: Vec<f64>,
    /// Mean distance, as a rotation angle, of the poses from the subspace of this and all previous geodesics; NaN
    /// without poses.
    pub residual: f64,
    /// The objective, of distances on S³, at the steps of the descent; it never increases.
    pub descent: Vec<f64>,
}

/// Principal geodesics of whole poses through `means`, `(joints, 4)`.
///
/// # Errors
/// [`Error::Length`] if the number of means is not that of the joints; [`Error::Interrupted`].
pub fn body_geodesics<T: Real>(
    clip: ClipView<'_, T>,
    means: &[T],
    params: Params,
    interrupt: &Interrupt,
) -> Result<Vec<Component>, Error> {
    let joints = clip.joints();
    let means = wide_means(means, joints)?;
    let mut poses = Poses::of_frames(clip, &frames_with_samples(clip), &means, interrupt)?;
    let everything: Vec<usize> = (0..joints).collect();
    let rest = vec![0.0; joints * 3];
    let mut angle = mean_distance(&mut poses, &rest, &everything, false, interrupt)?.0;
    let mut components: Vec<Component> = Vec::new();
    while components.len() < params.components
        || (params.components == 0 && components.len() < params.most && angle > params.tolerance)
    {
        let before = components.last().map(|component| &component.direction[..]);
        let Found { mut direction, descent } = next_direction(&poses, before, params.objective, interrupt)?;
        let s;
        (angle, s) = mean_distance(&mut poses, &direction, &everything, true, interrupt)?;
        if decides_against(&s) {
            for x in &mut direction {
                *x = -*x;
            }
        }
        components.push(Component { direction, residual: angle, descent });
    }
    Ok(components)
}

/// Means in float64.
fn wide_means<T: Real>(means: &[T], joints: usize) -> Result<Vec<[f64; 4]>, Error> {
    check_length("means", joints * 4, means.len())?;
    let (means, _) = means.as_chunks::<4>();
    Ok(means.iter().map(|mean| mean.map(T::to_f64)).collect())
}

/// Frames with at least one valid sample.
fn frames_with_samples<T: Real>(clip: ClipView<'_, T>) -> Vec<usize> {
    let seen = |frame: &usize| (0..clip.joints()).any(|joint| !is_missing(clip.at(*frame, joint)));
    (0..clip.frames()).filter(seen).collect()
}

/// Direction of the geodesic nearest to the poses; `before` is the previous direction.
/// Joints that do not move have zero components. If a single joint moves, its own nearest geodesic is the body's.
fn next_direction(
    poses: &Poses,
    before: Option<&[f64]>,
    objective: Objective,
    interrupt: &Interrupt,
) -> Result<Found, Error> {
    let which = poses.moving(NOTHING_LEFT, interrupt)?;
    let mut direction = vec![0.0; poses.joints * 3];
    let Some(&first) = which.first() else {
        if let Some(x) = direction.first_mut() {
            *x = 1.0;
        }
        return Ok(Found { direction, descent: vec![0.0; poses.count.min(1)] });
    };
    if which.len() == 1 {
        let (v, descent) = of_joint(poses, first, before, objective, interrupt)?;
        direction[first * 3..first * 3 + 3].copy_from_slice(&v);
        return Ok(Found { direction, descent });
    }
    let ground = Ground { poses, which: &which, objective, interrupt };
    let found = nearest::nearest_geodesic(ground)?;
    for (v, &joint) in found.direction.chunks_exact(3).zip(&which) {
        direction[joint * 3..joint * 3 + 3].copy_from_slice(v);
    }
    Ok(Found { direction, descent: found.descent })
}

/// The nearest geodesic if a single joint moves.
fn of_joint(
    poses: &Poses,
    joint: usize,
    before: Option<&[f64]>,
    objective: Objective,
    interrupt: &Interrupt,
) -> Result<([f64; 3], Vec<f64>), Error> {
    let samples: Vec<[f64; 4]> =
        (0..poses.count).map(|pose| poses.at(pose, joint)).filter(|x| !is_missing(*x)).collect();
    let at = joint * 3;
    let last = before
        .filter(|v| v.iter().enumerate().all(|(i, &x)| (at..at + 3).contains(&i) || x == 0.0))
        .map(|v| [v[at], v[at + 1], v[at + 2]]);
    let (v, mut descent) = nearest_of_joint(&samples, last, objective, interrupt)?;
    let share = samples.len() as f64 / poses.count as f64;
    for value in &mut descent {
        *value *= share;
    }
    Ok((v, descent))
}

/// Mean distance of the poses from a geodesic, as a rotation angle, and the parameters of the nearest points. With
/// `remove`, the poses are replaced by their residuals.
fn mean_distance(
    poses: &mut Poses,
    v: &[f64],
    which: &[usize],
    remove: bool,
    interrupt: &Interrupt,
) -> Result<(f64, Vec<Lane>), Error> {
    let part = parts(v, which);
    let nanoseconds = poses.count * which.len() * SAMPLE_NANOSECONDS;
    let parts = parallel::map(poses.tiles.iter_mut().collect(), nanoseconds, |_, tile: &mut Tile| {
        interrupt.check()?;
        let mut s = Lane::ZERO;
        let nearest = nearest_points(tile, &part, false, &mut s);
        if remove {
            take_away(tile, &part, &s);
        }
        Ok((nearest.sums.square.0.iter().map(|square| square.sqrt()).sum::<f64>(), s))
    })?;
    let total: f64 = parts.iter().map(|(sum, _)| sum).sum();
    Ok((2.0 * total / poses.count as f64, parts.into_iter().map(|(_, s)| s).collect()))
}

/// Whether the first pose whose parameter is large enough has a negative one; padding poses have 0.
fn decides_against(s: &[Lane]) -> bool {
    let all = || s.iter().flat_map(|lane| lane.0);
    let most = all().fold(0.0, |most, s| f64::max(most, s.abs()));
    all().find(|s| s.abs() >= DECISIVE * most).is_some_and(f64::is_sign_negative)
}

/// Frames per task of passes over whole clips.
const TASK: usize = 4 * TILE;
