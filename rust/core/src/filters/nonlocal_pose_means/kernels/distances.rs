//! From planes to patch distances and weights.

use super::SHIFT;
use crate::Real;
use crate::rotations::quaternion::{between, log_short};
use crate::simd::multiversion;

multiversion! {
    /// `d += factor·‖y − x‖²`.
    pub(in super::super) fn add_squares<T: Real>(d: &mut [T], x: [&[T]; 3], y: [&[T]; 3], factor: T) {
        let n = d.len();
        let [x0, x1, x2] = x.map(|x| &x[..n]);
        let [y0, y1, y2] = y.map(|y| &y[..n]);
        for i in 0..n {
            let (a, b, c) = (y0[i] - x0[i], y1[i] - x1[i], y2[i] - x2[i]);
            d[i] += factor * (a * a + b * b + c * c);
        }
    }
}

multiversion! {
    /// `c = a·b`.
    pub(in super::super) fn multiply_planes<T: Real>(c: &mut [T], a: &[T], b: &[T]) {
        let n = c.len();
        let (a, b) = (&a[..n], &b[..n]);
        for i in 0..n {
            c[i] = a[i] * b[i];
        }
    }
}

multiversion! {
    /// `d += factor·share·s`, `n += share`.
    pub(in super::super) fn add_shares<T: Real>(d: &mut [T], n: &mut [T], s: &[T], share: &[T], factor: T) {
        let length = d.len();
        let (n, s, share) = (&mut n[..length], &s[..length], &share[..length]);
        for i in 0..length {
            d[i] += factor * share[i] * s[i];
            n[i] += share[i];
        }
    }
}

multiversion! {
    /// Half rotation vectors `log(q⁻¹r)` of the shorter rotation.
    pub(in super::super) fn pair_logs<T: Real>(q: [&[T]; 4], r: [&[T]; 4], x: &mut [T], y: &mut [T], z: &mut [T]) {
        let n = x.len();
        let q = q.map(|q| &q[..n]);
        let r = r.map(|r| &r[..n]);
        let (y, z) = (&mut y[..n], &mut z[..n]);
        for i in 0..n {
            let v = log_short(between([q[0][i], q[1][i], q[2][i], q[3][i]], [r[0][i], r[1][i], r[2][i], r[3][i]]));
            x[i] = v[0];
            y[i] = v[1];
            z[i] = v[2];
        }
    }
}

multiversion! {
    /// `d += factor·‖v‖²`.
    pub(in super::super) fn add_lengths<T: Real>(d: &mut [T], v: [&[T]; 3], factor: T) {
        let n = d.len();
        let [x, y, z] = v.map(|v| &v[..n]);
        for i in 0..n {
            d[i] += factor * (x[i] * x[i] + y[i] * y[i] + z[i] * z[i]);
        }
    }
}

multiversion! {
    /// Converts patch distances to exponents: divides by three times the sum of weights; infinite where that is 0.
    pub(in super::super) fn divide_by_shares<T: Real>(e: &mut [T], shares: &[T]) {
        let n = e.len();
        let shares = &shares[..n];
        for i in 0..n {
            let some = shares[i] > T::ZERO;
            let mean = e[i] / (shares[i] * T::from_f64(3.0));
            e[i] = if some { mean } else { T::ONE / T::ZERO };
        }
    }
}

multiversion! {
    /// Sets exponents to infinity where the sum of weights is 0.
    pub(in super::super) fn exclude_without_shares<T: Real>(e: &mut [T], shares: &[T]) {
        let n = e.len();
        let shares = &shares[..n];
        for i in 0..n {
            e[i] = if shares[i] > T::ZERO { e[i] } else { T::ONE / T::ZERO };
        }
    }
}

/// Exponent beyond which a candidate has no weight, in either precision.
pub(in super::super) const FARTHEST: f64 = 120.0;

multiversion! {
    /// `e ← exp(60 − scale·e)`; 0 beyond [`FARTHEST`].
    pub(in super::super) fn weigh<T: Real>(e: &mut [T], scale: T) {
        for e in e {
            let exponent = *e * scale;
            let weight = (T::from_f64(SHIFT) - exponent).exp();
            *e = if exponent <= T::from_f64(FARTHEST) { weight } else { T::ZERO };
        }
    }
}
