//! The centre of rotations, and its uniqueness.

use super::samples::{LANES, Quad, Samples};
use crate::eigen::eigenvectors;
use crate::parallel::{self, Interrupt};
use crate::rotations::mean::mean;
use crate::rotations::quaternion::{angle_between, between, exp_one, product, unit};
use crate::simd::multiversion;
use crate::{ClipView, Error, Real};

/// Rotation angle, radians: if all samples are nearer to their mean, it is unique (Afsari 2011).
const CERTAIN_RADIUS: f64 = std::f64::consts::FRAC_PI_2;

/// Radians on S³: two results of the iteration that are nearer are the same mean.
const SAME_MEAN: f64 = 1e-6;

/// Largest number of samples used to search for another mean.
const SUBSET: usize = 4096;

/// Relative difference of mean squared distances up to which another mean is equally good.
const AS_GOOD: f64 = 1e-9;

/// Step length, radians on S³, at which the iteration ends.
const STEP: f64 = 1e-14;

/// Largest number of steps.
const ITERATIONS: usize = 100;

/// The centre of a joint's rotations.
#[derive(Debug, Clone, Copy)]
pub struct Centre {
    /// Karcher mean with `w ≥ 0`; NaN for a joint without samples.
    pub mean: [f64; 4],
    /// Greatest rotation angle from the mean to a sample; NaN for a joint without samples.
    pub radius: f64,
    /// Whether no other rotation has as small a mean squared distance to the samples. The candidates are the results
    /// of the iteration from the principal axes of the samples in R⁴ and from the diagonals between them.
    pub unique: bool,
}

/// Karcher mean of each joint, the largest distance of its samples, and whether the mean is unique.
///
/// # Errors
/// [`Error::Interrupted`].
pub fn geodesic_centre<T: Real>(clip: ClipView<'_, T>, interrupt: &Interrupt) -> Result<Vec<Centre>, Error> {
    let (frames, joints) = (clip.frames(), clip.joints());
    let wide: Vec<f64> = clip.data().iter().map(|x| x.to_f64()).collect();
    let means = mean(ClipView::new(&wide, frames, joints)?, None, interrupt)?;
    parallel::map(means, frames * joints * 20, |joint, mean| {
        let samples = Samples::of_joint(clip, joint, mean);
        if samples.count() == 0 {
            return Ok(Centre { mean: [f64::NAN; 4], radius: f64::NAN, unique: true });
        }
        let radius = samples.greatest_angle(interrupt)?;
        let unique = radius < CERTAIN_RADIUS || is_only_mean(&samples.subset(SUBSET), interrupt)?;
        Ok(Centre { mean, radius, unique })
    })
}

/// Whether all other starts of the iteration lead to a larger mean square than the start at 1.
fn is_only_mean(samples: &Samples, interrupt: &Interrupt) -> Result<bool, Error> {
    let count = samples.count() as f64;
    let mut sums = samples.sums(3, interrupt, add_moments)?;
    sums[0] -= samples.filling() as f64;
    let mut matrix = [0.0; 16];
    let mut entries = sums.into_iter();
    for i in 0..4 {
        for j in i..4 {
            let entry = entries.next().unwrap_or(0.0);
            (matrix[i * 4 + j], matrix[j * 4 + i]) = (entry, entry);
        }
    }
    let vectors = eigenvectors(&mut matrix, 4, interrupt)?;
    let axes: [[f64; 4]; 4] = std::array::from_fn(|axis| std::array::from_fn(|i| vectors[i * 4 + axis]));
    let mut starts = axes.to_vec();
    for signs in 0..8 {
        let sign = |bit: usize| if signs >> bit & 1 == 0 { 0.5 } else { -0.5 };
        let weights = [0.5, sign(0), sign(1), sign(2)];
        starts.push(std::array::from_fn(|i| (0..4).map(|axis| weights[axis] * axes[axis][i]).sum()));
    }
    let (here, square) = iterated(samples, [1.0, 0.0, 0.0, 0.0], interrupt)?;
    let least = square / count * (1.0 + AS_GOOD);
    for start in starts {
        let (other, square) = iterated(samples, start, interrupt)?;
        let apart = 0.5 * angle_between(here, other);
        if apart > SAME_MEAN && square / count <= least {
            return Ok(false);
        }
    }
    Ok(true)
}

/// Result of the iteration for the mean from a start, and the sum of squared distances there.
fn iterated(samples: &Samples, start: [f64; 4], interrupt: &Interrupt) -> Result<([f64; 4], f64), Error> {
    let mut x = start;
    let mut square = f64::INFINITY;
    for _ in 0..=ITERATIONS {
        let sums = samples.sums(5, interrupt, |part, sums| add_logarithms(part, x, sums))?;
        let mut filling = [[0.0; LANES]; 4];
        add_logarithms([&[1.0; LANES], &[0.0; LANES], &[0.0; LANES], &[0.0; LANES]], x, &mut filling);
        let [a, b, c, sum] = std::array::from_fn(|i| sums[i] - filling[i][0] * samples.filling() as f64);
        square = sum;
        let step = [a, b, c].map(|total| total / samples.count() as f64);
        if (step[0] * step[0] + step[1] * step[1] + step[2] * step[2]).sqrt() < STEP {
            break;
        }
        x = unit(product(x, exp_one(step)));
    }
    Ok((x, square))
}

multiversion! {
    /// Sums of the entries of `q qᵀ`.
    fn add_moments(samples: Quad<'_>, sums: &mut [[f64; LANES]; 10]) {
        let total = sums;
        let mut sums = *total;
        let [w, x, y, z] = samples.map(|plane| plane.as_chunks::<LANES>().0);
        for (((w, x), y), z) in w.iter().zip(x).zip(y).zip(z) {
            for c in 0..LANES {
                sums[0][c] += w[c] * w[c];
                sums[1][c] += w[c] * x[c];
                sums[2][c] += w[c] * y[c];
                sums[3][c] += w[c] * z[c];
                sums[4][c] += x[c] * x[c];
                sums[5][c] += x[c] * y[c];
                sums[6][c] += x[c] * z[c];
                sums[7][c] += y[c] * y[c];
                sums[8][c] += y[c] * z[c];
                sums[9][c] += z[c] * z[c];
            }
        }
        *total = sums;
    }
}

multiversion! {
    /// Sums of the logarithms relative to `centre`, of the shorter rotations, and of their squares.
    fn add_logarithms(samples: Quad<'_>, centre: [f64; 4], sums: &mut [[f64; LANES]; 4]) {
        let total = sums;
        let mut sums = *total;
        let [w, x, y, z] = samples.map(|plane| plane.as_chunks::<LANES>().0);
        for (((w, x), y), z) in w.iter().zip(x).zip(y).zip(z) {
            for c in 0..LANES {
                let d = between(centre, [w[c], x[c], y[c], z[c]]);
                let sine = (d[1] * d[1] + d[2] * d[2] + d[3] * d[3] + f64::TINY_SQUARE).sqrt();
                let angle = sine.atan2_nonnegative(d[0].abs());
                let factor = (angle / sine).copysign(d[0]);
                sums[0][c] += factor * d[1];
                sums[1][c] += factor * d[2];
                sums[2][c] += factor * d[3];
                sums[3][c] += angle * angle;
            }
        }
        *total = sums;
    }
}
