//! The vectorised loops: maps over frames on planes.

use crate::Real;
use crate::clip::Planes;
use crate::rotations::quaternion::{between, dot, exp_one, log_one, log_short, product};
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

/// Up to [`LANE`] samples, `step` apart, as planes; the rest is the identity.
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

/// The exponent beyond which a candidate has no weight, in either precision.
pub(super) const FARTHEST: f64 = 120.0;

multiversion! {
    /// `e ← exp(60 − scale·e)`; 0 beyond [`FARTHEST`].
    pub(super) fn weigh<T: Real>(e: &mut [T], scale: T) {
        for e in e {
            let exponent = *e * scale;
            let weight = (T::from_f64(SHIFT) - exponent).exp();
            *e = if exponent <= T::from_f64(FARTHEST) { weight } else { T::ZERO };
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
                let inside = later + LANE <= length && earlier < length && earlier + LANE <= length;
                if inside {
                    let after: [&[T]; N] = std::array::from_fn(|n| &planes[n][later..later + LANE]);
                    let before: [&[T]; N] = std::array::from_fn(|n| &planes[n][earlier..earlier + LANE]);
                    for i in 0..LANE {
                        for n in 0..N {
                            lane[n][i] += f[i] * after[n][i] + b[i] * before[n][i];
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
        /// Pairs at once: one vector of float32 at the widest level.
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
