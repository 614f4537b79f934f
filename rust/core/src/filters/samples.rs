//! From quaternions to planes and back.

use crate::Real;
use crate::rotations::quaternion::{dot, exp_one, log_one, product};
use crate::simd::multiversion;

/// Frames per block of a loop over lags: four vectors of float32 at the widest level.
pub(super) const LANE: usize = 64;

multiversion! {
    /// Copies samples, and negates those that are marked.
    pub(super) fn copy_signed<T: Real>(samples: &[[T; 4]], flips: &[u8], out: &mut [[T; 4]]) {
        let n = samples.len();
        let (flips, out) = (&flips[..n], &mut out[..n]);
        for i in 0..n {
            let sign = if flips[i] == 0 { T::ONE } else { -T::ONE };
            let [w, x, y, z] = samples[i];
            out[i] = [w * sign, x * sign, y * sign, z * sign];
        }
    }
}

multiversion! {
    /// Half rotation vectors of `m⁻¹q` for up to [`LANE`] samples of one joint, `step` samples apart.
    pub(super) fn load_fixed<T: Real>(
        samples: &[[T; 4]], step: usize, inverse: [T; 4],
        x: &mut [T], y: &mut [T], z: &mut [T],
    ) {
        let q = gather(samples, step);
        let n = x.len().min(LANE);
        let mut v = [[T::ZERO; LANE]; 3];
        for i in 0..LANE {
            let one = log_one(product(inverse, [q[0][i], q[1][i], q[2][i], q[3][i]]));
            v[0][i] = one[0];
            v[1][i] = one[1];
            v[2][i] = one[2];
        }
        x[..n].copy_from_slice(&v[0][..n]);
        y[..n].copy_from_slice(&v[1][..n]);
        z[..n].copy_from_slice(&v[2][..n]);
    }
}

multiversion! {
    /// Unit quaternions of up to [`LANE`] samples of one joint, `step` samples apart.
    pub(super) fn load_local<T: Real>(
        samples: &[[T; 4]], step: usize,
        w: &mut [T], x: &mut [T], y: &mut [T], z: &mut [T],
    ) {
        let q = gather(samples, step);
        let n = w.len().min(LANE);
        let mut scale = [T::ZERO; LANE];
        for i in 0..LANE {
            let square = (q[0][i] * q[0][i] + q[1][i] * q[1][i]) + (q[2][i] * q[2][i] + q[3][i] * q[3][i]);
            scale[i] = T::ONE / square.sqrt();
        }
        for (plane, q) in [w, x, y, z].into_iter().zip(&q) {
            for i in 0..n {
                plane[i] = q[i] * scale[i];
            }
        }
    }
}

/// Up to [`LANE`] samples, `step` apart, as planes, padded with the identity.
#[inline(always)]
fn gather<T: Real>(samples: &[[T; 4]], step: usize) -> [[T; LANE]; 4] {
    let mut near = [[T::ONE, T::ZERO, T::ZERO, T::ZERO]; LANE];
    for (near, sample) in near.iter_mut().zip(samples.iter().step_by(step)) {
        *near = *sample;
    }
    let mut q = [[T::ONE; LANE]; 4];
    for i in 0..LANE {
        q[0][i] = near[i][0];
        q[1][i] = near[i][1];
        q[2][i] = near[i][2];
        q[3][i] = near[i][3];
    }
    q
}

multiversion! {
    /// Writes `sign·m·exp(v)` of [`LANE`] frames to every `step`-th sample.
    pub(super) fn store_fixed<T: Real>(v: [&[T]; 3], centre: [T; 4], sign: T, out: &mut [[T; 4]], step: usize) {
        let centre = [centre[0] * sign, centre[1] * sign, centre[2] * sign, centre[3] * sign];
        let [x, y, z] = v.map(|v| &v[..LANE]);
        let mut q = [[T::ZERO; LANE]; 4];
        for i in 0..LANE {
            let one = product(centre, exp_one([x[i], y[i], z[i]]));
            q[0][i] = one[0];
            q[1][i] = one[1];
            q[2][i] = one[2];
            q[3][i] = one[3];
        }
        scatter(&q, out, step);
    }
}

multiversion! {
    /// Writes `sign·q·exp(v)` of [`LANE`] frames to every `step`-th sample.
    pub(super) fn store_local<T: Real>(v: [&[T]; 3], base: [&[T]; 4], sign: T, out: &mut [[T; 4]], step: usize) {
        let [x, y, z] = v.map(|v| &v[..LANE]);
        let base = base.map(|base| &base[..LANE]);
        let mut q = [[T::ZERO; LANE]; 4];
        for i in 0..LANE {
            let from = [base[0][i] * sign, base[1][i] * sign, base[2][i] * sign, base[3][i] * sign];
            let one = product(from, exp_one([x[i], y[i], z[i]]));
            q[0][i] = one[0];
            q[1][i] = one[1];
            q[2][i] = one[2];
            q[3][i] = one[3];
        }
        scatter(&q, out, step);
    }
}

/// Writes [`LANE`] quaternions to every `step`-th sample.
#[inline(always)]
fn scatter<T: Real>(q: &[[T; LANE]; 4], out: &mut [[T; 4]], step: usize) {
    let mut near = [[T::ZERO; 4]; LANE];
    for i in 0..LANE {
        near[i] = [q[0][i], q[1][i], q[2][i], q[3][i]];
    }
    for (near, sample) in near.iter().zip(out.iter_mut().step_by(step)) {
        *sample = *near;
    }
}

multiversion! {
    /// Whether the inner product of any pair is negative.
    pub(super) fn turns<T: Real>(before: &[[T; 4]], after: &[[T; 4]]) -> bool {
        /// Pairs per iteration: one vector of float32 at the widest level.
        const PAIRS: usize = 16;
        let mut least = [T::ZERO; PAIRS];
        let n = before.len().min(after.len());
        let (before, before_rest) = before[..n].as_chunks::<PAIRS>();
        let (after, after_rest) = after[..n].as_chunks::<PAIRS>();
        for (a, b) in before.iter().zip(after) {
            for i in 0..PAIRS {
                least[i] = least[i].min(dot(a[i], b[i]));
            }
        }
        let rest = before_rest.iter().zip(after_rest).any(|(a, b)| dot(*a, *b) < T::ZERO);
        rest || least.iter().any(|&x| x < T::ZERO)
    }
}
