//! The vectorised loops: maps over frames on planes.

use crate::Real;
use crate::clip::Planes;
use crate::rotations::quaternion::{between, exp_one, log_one, log_short, product};
use crate::simd::multiversion;

/// Frames that a loop over lags keeps at hand: four vectors of float32 at the widest level.
pub(super) const LANE: usize = 64;

/// Weights are kept times `e⁶⁰`, so that those far below the floor of the self-weight are still normal float32 numbers
/// and sums of a million of the largest do not overflow.
pub(super) const SHIFT: f64 = 60.0;

multiversion! {
    /// Half rotation vectors of `sign·m⁻¹q` for up to [`LANE`] samples of one joint, `step` samples apart.
    pub(super) fn load_fixed<T: Real>(
        samples: &[[T; 4]], step: usize, signs: &[T; LANE], inverse: [T; 4],
        x: &mut [T], y: &mut [T], z: &mut [T],
    ) {
        let q = gather(samples, step);
        let n = x.len().min(LANE);
        let mut v = [[T::ZERO; LANE]; 3];
        for i in 0..LANE {
            let s = signs[i];
            let one = log_one(product(inverse, [q[0][i] * s, q[1][i] * s, q[2][i] * s, q[3][i] * s]));
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
    /// Unit quaternions `sign·q` of up to [`LANE`] samples of one joint, `step` samples apart.
    pub(super) fn load_local<T: Real>(
        samples: &[[T; 4]], step: usize, signs: &[T; LANE],
        w: &mut [T], x: &mut [T], y: &mut [T], z: &mut [T],
    ) {
        let q = gather(samples, step);
        let n = w.len().min(LANE);
        let mut scale = [T::ZERO; LANE];
        for i in 0..LANE {
            let square = (q[0][i] * q[0][i] + q[1][i] * q[1][i]) + (q[2][i] * q[2][i] + q[3][i] * q[3][i]);
            scale[i] = signs[i] / square.sqrt();
        }
        for (plane, q) in [w, x, y, z].into_iter().zip(&q) {
            for i in 0..n {
                plane[i] = q[i] * scale[i];
            }
        }
    }
}

/// Up to [`LANE`] samples, `step` apart; the rest is the identity.
#[inline(always)]
fn gather<T: Real>(samples: &[[T; 4]], step: usize) -> [[T; LANE]; 4] {
    let mut q = [[T::ONE; LANE]; 4];
    for (i, sample) in samples.iter().step_by(step).take(LANE).enumerate() {
        q[0][i] = sample[0];
        q[1][i] = sample[1];
        q[2][i] = sample[2];
        q[3][i] = sample[3];
    }
    q
}

multiversion! {
    /// `d += factor·‖y − x‖²`.
    pub(super) fn add_squares<T: Real>(d: &mut [T], x: [&[T]; 3], y: [&[T]; 3], factor: T) {
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
    pub(super) fn multiply_planes<T: Real>(c: &mut [T], a: &[T], b: &[T]) {
        let n = c.len();
        let (a, b) = (&a[..n], &b[..n]);
        for i in 0..n {
            c[i] = a[i] * b[i];
        }
    }
}

multiversion! {
    /// `d += factor·share·s`, `n += share`.
    pub(super) fn add_shares<T: Real>(d: &mut [T], n: &mut [T], s: &[T], share: &[T], factor: T) {
        let length = d.len();
        let (n, s, share) = (&mut n[..length], &s[..length], &share[..length]);
        for i in 0..length {
            d[i] += factor * share[i] * s[i];
            n[i] += share[i];
        }
    }
}

multiversion! {
    /// Half rotation vectors `log(q⁻¹r)` of the shorter way.
    pub(super) fn pair_logs<T: Real>(q: [&[T]; 4], r: [&[T]; 4], x: &mut [T], y: &mut [T], z: &mut [T]) {
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
    pub(super) fn add_lengths<T: Real>(d: &mut [T], v: [&[T]; 3], factor: T) {
        let n = d.len();
        let [x, y, z] = v.map(|v| &v[..n]);
        for i in 0..n {
            d[i] += factor * (x[i] * x[i] + y[i] * y[i] + z[i] * z[i]);
        }
    }
}

multiversion! {
    /// `to[i] = a[i] + a[i + shift]`.
    fn add_shifted<T: Real>(to: &mut [T], a: &[T], shift: usize) {
        let n = to.len();
        let (a, b) = (&a[..n], &a[shift..shift + n]);
        for i in 0..n {
            to[i] = a[i] + b[i];
        }
    }
}

multiversion! {
    /// `to += a`.
    fn add_plane<T: Real>(to: &mut [T], a: &[T]) {
        let n = to.len();
        let a = &a[..n];
        for i in 0..n {
            to[i] += a[i];
        }
    }
}

/// Sums over a sliding window: `out[i] = values[i] + … + values[i + window − 1]`.
///
/// Windows are put together from sums over powers of two, so the cost hardly grows with the window, every sum is of
/// positive terms only, and none runs on: a burst in one place leaves no error elsewhere. `values` is used up.
pub(super) fn sliding_sums<T: Real>(values: &mut Vec<T>, spare: &mut Vec<T>, window: usize, out: &mut [T]) {
    let n = out.len();
    out.fill(T::ZERO);
    let (mut covered, mut power) = (0, 1);
    loop {
        if window & power != 0 {
            add_plane(out, &values[covered..covered + n]);
            covered += power;
        }
        if covered == window {
            return;
        }
        let length = values.len() - power;
        spare.resize(length, T::ZERO);
        add_shifted(&mut spare[..length], values, power);
        std::mem::swap(values, spare);
        values.truncate(length);
        power *= 2;
    }
}

multiversion! {
    /// Patch distances to exponents: divided by three times the share that entered; infinite where nothing did.
    pub(super) fn divide_by_shares<T: Real>(e: &mut [T], shares: &[T]) {
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
    /// Infinite exponents where nothing entered.
    pub(super) fn exclude_without_shares<T: Real>(e: &mut [T], shares: &[T]) {
        let n = e.len();
        let shares = &shares[..n];
        for i in 0..n {
            e[i] = if shares[i] > T::ZERO { e[i] } else { T::ONE / T::ZERO };
        }
    }
}

multiversion! {
    /// `e ← exp(60 − scale·e)`.
    pub(super) fn weigh<T: Real>(e: &mut [T], scale: T) {
        for e in e {
            *e = (T::from_f64(SHIFT) - *e * scale).exp();
        }
    }
}

multiversion! {
    /// Keeps the largest weight and adds to the total.
    pub(super) fn note_weights<T: Real>(most: &mut [T], total: &mut [T], weights: &[T]) {
        let n = weights.len();
        let (most, total) = (&mut most[..n], &mut total[..n]);
        for i in 0..n {
            most[i] = most[i].max(weights[i]);
            total[i] += weights[i];
        }
    }
}

multiversion! {
    /// `sums += weights·values`, or `−=` with `sign = −1`.
    pub(super) fn add_products<T: Real>(sums: &mut [T], weights: &[T], values: &[T], sign: T) {
        let n = sums.len();
        let (weights, values) = (&weights[..n], &values[..n]);
        for i in 0..n {
            sums[i] += sign * weights[i] * values[i];
        }
    }
}

multiversion! {
    /// Adds, for each lag of a block, the weighted later and earlier samples of `N` planes.
    ///
    /// `forward` and `backward` hold a row of weights per lag, the first for the lag `lag`; frame `i` of the tile stands at
    /// `at + i` in the planes. Samples outside of the planes must have weight 0.
    pub(super) fn accumulate<T: Real, const N: usize>(
        sums: [&mut [T]; N], planes: [&[T]; N], at: usize, lag: usize, lags: usize,
        forward: &Planes<T>, backward: &Planes<T>,
    ) {
        let mut sums = sums;
        let length = planes[0].len();
        for start in (0..sums[0].len()).step_by(LANE) {
            let mut lane = [[T::ZERO; LANE]; N];
            for l in 0..lags {
                let shift = lag + l;
                let f = &forward.row(l)[start..start + LANE];
                let b = &backward.row(l)[start..start + LANE];
                let later = at + start + shift;
                let earlier = (at + start).wrapping_sub(shift);
                if later + LANE <= length && earlier < length && earlier + LANE <= length {
                    for (lane, plane) in lane.iter_mut().zip(&planes) {
                        let after = &plane[later..later + LANE];
                        let before = &plane[earlier..earlier + LANE];
                        for i in 0..LANE {
                            lane[i] += f[i] * after[i] + b[i] * before[i];
                        }
                    }
                } else {
                    for (lane, plane) in lane.iter_mut().zip(&planes) {
                        for i in 0..LANE {
                            let after = plane.get(later + i).map_or(T::ZERO, |x| f[i] * *x);
                            let before = plane.get(earlier.wrapping_add(i)).map_or(T::ZERO, |x| b[i] * *x);
                            lane[i] += after + before;
                        }
                    }
                }
            }
            for (sums, lane) in sums.iter_mut().zip(&lane) {
                let sums = &mut sums[start..start + LANE];
                for i in 0..LANE {
                    sums[i] += lane[i];
                }
            }
        }
    }
}

multiversion! {
    /// Means in the chart: `(sums + own·x) / (total + own)`, into `sums`; `x` itself where nothing has weight.
    pub(super) fn settle<T: Real>(sums: &mut [T], x: &[T], total: &[T], own: &[T]) {
        let n = sums.len();
        let (x, total, own) = (&x[..n], &total[..n], &own[..n]);
        for i in 0..n {
            let weight = total[i] + own[i];
            let mean = (sums[i] + own[i] * x[i]) / weight;
            sums[i] = if weight > T::ZERO { mean } else { x[i] };
        }
    }
}

multiversion! {
    /// Means about the sample itself: `sums / (total + own)`, into `sums`; 0 where nothing has weight.
    pub(super) fn settle_local<T: Real>(sums: &mut [T], total: &[T], own: &[T]) {
        let n = sums.len();
        let (total, own) = (&total[..n], &own[..n]);
        for i in 0..n {
            let weight = total[i] + own[i];
            let mean = sums[i] / weight;
            sums[i] = if weight > T::ZERO { mean } else { T::ZERO };
        }
    }
}

multiversion! {
    /// Writes `sign·m·exp(v)` to every `step`-th sample.
    pub(super) fn store_fixed<T: Real>(v: [&[T]; 3], centre: [T; 4], sign: T, out: &mut [[T; 4]], step: usize) {
        let centre = [centre[0] * sign, centre[1] * sign, centre[2] * sign, centre[3] * sign];
        scatter(v, out, step, |_| centre);
    }
}

multiversion! {
    /// Writes `sign·q·exp(v)` to every `step`-th sample.
    pub(super) fn store_local<T: Real>(v: [&[T]; 3], q: [&[T]; 4], sign: T, out: &mut [[T; 4]], step: usize) {
        let n = v[0].len();
        let q = q.map(|q| &q[..n]);
        scatter(v, out, step, |i| [q[0][i] * sign, q[1][i] * sign, q[2][i] * sign, q[3][i] * sign]);
    }
}

/// Writes `base(i)·exp(vᵢ)` to every `step`-th sample, in lanes.
#[inline(always)]
fn scatter<T: Real>(v: [&[T]; 3], out: &mut [[T; 4]], step: usize, base: impl Fn(usize) -> [T; 4]) {
    let n = v[0].len();
    let v = v.map(|v| &v[..n]);
    for start in (0..n).step_by(LANE) {
        let width = LANE.min(n - start);
        let mut q = [[T::ZERO; LANE]; 4];
        if width == LANE {
            for i in 0..LANE {
                let t = start + i;
                let one = product(base(t), exp_one([v[0][t], v[1][t], v[2][t]]));
                for c in 0..4 {
                    q[c][i] = one[c];
                }
            }
        } else {
            for i in 0..width {
                let t = start + i;
                let one = product(base(t), exp_one([v[0][t], v[1][t], v[2][t]]));
                for c in 0..4 {
                    q[c][i] = one[c];
                }
            }
        }
        for (i, sample) in out[start * step..].iter_mut().step_by(step).take(width).enumerate() {
            *sample = [q[0][i], q[1][i], q[2][i], q[3][i]];
        }
    }
}
