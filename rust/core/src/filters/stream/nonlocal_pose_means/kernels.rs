//! Vectorised loops over joints or candidates on planes.

use crate::Real;
use crate::rotations::quaternion::{between, exp_one, log_one, log_short, product, unit};
use crate::simd::multiversion;

/// Exponent beyond which a candidate has no weight, as in the filter of the whole clip.
const FARTHEST: f64 = 120.0;

multiversion! {
    /// `to += a`.
    pub(super) fn add<T: Real>(to: &mut [T], a: &[T]) {
        let n = to.len();
        let a = &a[..n];
        for i in 0..n {
            to[i] += a[i];
        }
    }
}

multiversion! {
    /// `c = a·b`.
    pub(super) fn multiply<T: Real>(a: &[T], b: &[T], c: &mut [T]) {
        let n = c.len();
        let (a, b) = (&a[..n], &b[..n]);
        for i in 0..n {
            c[i] = a[i] * b[i];
        }
    }
}

multiversion! {
    /// Half rotation vectors of unit quaternions; the sign matters.
    pub(super) fn logs<T: Real>(q: [&[T]; 4], v: [&mut [T]; 3]) {
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
    /// `factor·share·‖v‖²` of the rotation vectors `v` from `q` to `r`.
    pub(super) fn turn_terms<T: Real>(q: [&[T]; 4], r: [&[T]; 4], factors: &[T], shares: &[T], terms: &mut [T]) {
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
    pub(super) fn lead_terms<T: Real>(x: [&[T]; 3], y: [&[T]; 3], factors: &[T], shares: &[T], terms: &mut [T]) {
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
    /// Converts exponents to weights; 0 beyond [`FARTHEST`].
    pub(super) fn weigh<T: Real>(exponents: &mut [T]) {
        for e in exponents {
            let weight = (-*e).exp();
            *e = if *e <= T::from_f64(FARTHEST) { weight } else { T::ZERO };
        }
    }
}

multiversion! {
    /// Updates the largest weight, and adds the weights times their confidence to the total.
    pub(super) fn note<T: Real>(weights: &mut [T], confidence: &[T], most: &mut [T], total: &mut [T]) {
        let n = weights.len();
        let (confidence, most, total) = (&confidence[..n], &mut most[..n], &mut total[..n]);
        for i in 0..n {
            most[i] = most[i].max(weights[i]);
            weights[i] *= confidence[i];
            total[i] += weights[i];
        }
    }
}

multiversion! {
    /// Adds the weighted rotation vectors from `q` to `r`.
    pub(super) fn turn_to<T: Real>(q: [&[T]; 4], r: [&[T]; 4], weights: &[T], sums: [&mut [T]; 3]) {
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
    pub(super) fn lead_to<T: Real>(x: [&[T]; 3], y: [&[T]; 3], weights: &[T], sums: [&mut [T]; 3]) {
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
    /// Adds each frame's self-weight, the largest of the others but at least `floor`, times its confidence.
    pub(super) fn add_own<T: Real>(most: &[T], floor: T, confidence: &[T], total: &mut [T]) {
        let n = total.len();
        let (most, confidence) = (&most[..n], &confidence[..n]);
        for i in 0..n {
            total[i] += most[i].max(floor) * confidence[i];
        }
    }
}

multiversion! {
    /// `q·exp(sums / total)`; `q` where the total weight is 0.
    pub(super) fn move_from<T: Real>(q: [&[T]; 4], sums: [&[T]; 3], total: &[T], out: [&mut [T]; 4]) {
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
    /// `exp(v + sums / total)`; `exp v` where the total weight is 0.
    pub(super) fn move_in_chart<T: Real>(v: [&[T]; 3], sums: [&[T]; 3], total: &[T], out: [&mut [T]; 4]) {
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
