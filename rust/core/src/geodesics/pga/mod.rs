//! Exact principal geodesic analysis: successive geodesics of rotations through their mean.
//!
//! With `x = mean⁻¹ q`, in the half of S³ about 1, the first direction `v` minimises the distance of the geodesic
//! `(cos s, sin s · v)` to the samples. The next is fitted to the residuals `π_v(x)⁻¹ x`, and so on (Said et al.
//! 2007). The vector parts of the residuals are orthogonal to the previous direction, and so is the next direction.

mod centre;
mod circle;
mod descent;
mod objective;
mod samples;
mod scores;
mod sphere;

pub use centre::{Centre, geodesic_centre};
pub use objective::Objective;
pub use scores::{Geodesics, geodesic_product, geodesic_scores};

use crate::error::check_length;
use crate::parallel::{self, Interrupt};
use crate::simd::multiversion;
use crate::{ClipView, Error, Real};
use descent::Found;
use samples::{LANES, Quad, Samples, dot};

/// Radians on S³: if all residuals are smaller, they are rounding errors and have no direction.
const NOTHING_LEFT: f64 = 1e-14;

/// Distance from a plane through 0, relative to the longest vector, up to which vectors lie in the plane within
/// rounding.
const FLAT: f64 = 1e-14;

/// A sample determines the sign of an axis if its parameter exceeds this fraction of the largest. Evenly spaced
/// samples of a swing never have exactly this fraction, so rounding does not decide.
const DECISIVE: f64 = 0.7;

/// Estimated nanoseconds per sample and geodesic: some fifty passes.
const SAMPLE_NANOSECONDS: usize = 300;

/// Parameters of the fit.
#[derive(Debug, Clone, Copy)]
pub struct Params {
    /// Number of geodesics; 0 for as many as it takes until each joint's mean angle is at most `tolerance`.
    pub components: usize,
    /// Largest number of geodesics if `components` is 0.
    pub most: usize,
    /// Objective of the directions.
    pub objective: Objective,
    /// Rotation angle, radians.
    pub tolerance: f64,
}

/// A geodesic of one joint.
#[derive(Debug, Clone)]
pub struct Component {
    /// Unit vector. The first sample whose parameter is at least 0.7 of the largest has a positive one.
    pub direction: [f64; 3],
    /// Mean rotation angle of the residuals of this and all previous geodesics; NaN without samples.
    pub residual: f64,
    /// The objective, of distances on S³, at the steps of the descent; it never increases.
    pub descent: Vec<f64>,
}

/// One joint: the residuals of its samples, and its last direction.
struct Joint {
    left: Samples,
    before: Option<[f64; 3]>,
}

/// Principal geodesics of each joint through `means`, `(joints, 4)`: for each component, one per joint.
///
/// # Errors
/// [`Error::Length`] if the number of means is not that of the joints; [`Error::Interrupted`].
pub fn principal_geodesics<T: Real>(
    clip: ClipView<'_, T>,
    means: &[T],
    params: Params,
    interrupt: &Interrupt,
) -> Result<Vec<Vec<Component>>, Error> {
    let joints = clip.joints();
    check_length("means", joints * 4, means.len())?;
    let nanoseconds = clip.frames() * joints * SAMPLE_NANOSECONDS;
    let (means, _) = means.as_chunks::<4>();
    let mut states = parallel::map(means.to_vec(), nanoseconds / 10, |joint, mean| {
        interrupt.check()?;
        Ok(Joint { left: Samples::of_joint(clip, joint, mean.map(T::to_f64)), before: None })
    })?;
    let mut angles = Vec::with_capacity(joints);
    for state in &states {
        angles.push(state.left.mean_angle(interrupt)?);
    }
    let mut components: Vec<Vec<Component>> = Vec::new();
    while components.len() < params.components
        || (params.components == 0
            && components.len() < params.most
            && angles.iter().any(|&angle| angle > params.tolerance))
    {
        let row = parallel::map(states.iter_mut().collect(), nanoseconds, |_, state: &mut Joint| {
            state.next(params.objective, interrupt)
        })?;
        angles = row.iter().map(|component| component.residual).collect();
        components.push(row);
    }
    Ok(components)
}

impl Joint {
    /// Fits a geodesic to the residuals, and removes it.
    fn next(&mut self, objective: Objective, interrupt: &Interrupt) -> Result<Component, Error> {
        let reach = self.reach(None, interrupt)?;
        let (mut direction, mut descent) = ([1.0, 0.0, 0.0], Vec::new());
        if reach > NOTHING_LEFT {
            Found { direction, descent } = self.nearest(reach, objective, interrupt)?;
            if decides_against(&self.left, direction, interrupt)? {
                direction = direction.map(|x| -x);
            }
        } else if self.left.count() > 0 {
            descent.push(objective::value(&self.left, direction, objective, interrupt)?);
        }
        self.left.take_away(direction, interrupt)?;
        self.before = Some(direction);
        let residual = self.left.mean_angle(interrupt)?;
        Ok(Component { direction, residual, descent })
    }

    /// The geodesic nearest to the residuals; `reach` is the length of their longest vector part.
    fn nearest(&self, reach: f64, objective: Objective, interrupt: &Interrupt) -> Result<Found, Error> {
        let plane = match (objective, self.before) {
            (Objective::Geodesic, Some(before)) => Some(objective::basis(before)),
            (Objective::Geodesic, None) => {
                let [first, second, off] = sphere::principal_axes(&self.left, false, interrupt)?;
                (self.reach(Some(off), interrupt)? <= FLAT * reach).then_some([first, second])
            }
            _ => None,
        };
        match plane {
            Some(plane) => circle::nearest_in_plane(&self.left, plane, interrupt),
            None => sphere::nearest_geodesic(&self.left, objective, interrupt),
        }
    }

    /// The largest length of a vector part, or of its component along an axis.
    fn reach(&self, axis: Option<[f64; 3]>, interrupt: &Interrupt) -> Result<f64, Error> {
        let parts = self.left.map(2, interrupt, |part, _| {
            let mut lanes = [0.0; LANES];
            longest(part, axis, &mut lanes);
            lanes.iter().fold(0.0, |a, &b| f64::max(a, b))
        })?;
        Ok(parts.into_iter().fold(0.0, f64::max))
    }
}

/// Direction of the geodesic nearest to the samples of one joint, and the objectives of the descent; `before` is the
/// previous direction.
pub(super) fn nearest_of_joint(
    samples: &[[f64; 4]],
    before: Option<[f64; 3]>,
    objective: Objective,
    interrupt: &Interrupt,
) -> Result<([f64; 3], Vec<f64>), Error> {
    let joint = Joint { left: Samples::filled(samples.len(), |i| samples[i]), before };
    let found = joint.nearest(joint.reach(None, interrupt)?, objective, interrupt)?;
    Ok((found.direction, found.descent))
}

/// Whether the first sample whose parameter along a geodesic is large enough has a negative one.
fn decides_against(samples: &Samples, v: [f64; 3], interrupt: &Interrupt) -> Result<bool, Error> {
    let parts = samples.map(4, interrupt, |part, _| {
        let mut parameters = vec![0.0; part[0].len()];
        along(part, v, &mut parameters);
        parameters
    })?;
    let most = parts.iter().flatten().fold(0.0, |most, s| f64::max(most, s.abs()));
    Ok(parts.iter().flatten().find(|s| s.abs() >= DECISIVE * most).is_some_and(|s| s.is_sign_negative()))
}

multiversion! {
    fn longest(samples: Quad<'_>, axis: Option<[f64; 3]>, most: &mut [f64; LANES]) {
        let [_, x, y, z] = samples.map(|plane| plane.as_chunks::<LANES>().0);
        for ((x, y), z) in x.iter().zip(y).zip(z) {
            for c in 0..LANES {
                let u = [x[c], y[c], z[c]];
                let length = match axis {
                    Some(axis) => dot(u, axis).abs(),
                    None => dot(u, u).sqrt(),
                };
                most[c] = if length > most[c] { length } else { most[c] };
            }
        }
    }
}

multiversion! {
    /// Parameters of the nearest points of a geodesic.
    fn along(samples: Quad<'_>, v: [f64; 3], parameters: &mut [f64]) {
        let [w, x, y, z] = samples;
        for ((((s, w), x), y), z) in parameters.iter_mut().zip(w).zip(x).zip(y).zip(z) {
            let p = dot([*x, *y, *z], v);
            *s = p.abs().atan2_nonnegative(*w).copysign(p);
        }
    }
}
