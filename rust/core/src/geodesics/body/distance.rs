//! Distances of poses from points of a geodesic in the product of all joints.
//!
//! The geodesic with the direction `v` is `c_v(s) = (exp(s v_1), …, exp(s v_J))`. A joint whose part `v_j = n e` has
//! the length `n` rotates by `θ = n s`. Relative to that point, its sample `x = (w, u)` has the scalar part `a = w
//! cos θ + p sin θ`, `p = e·u`, the component `b = p cos θ − w sin θ` along `e`, and `r = |u − p e|` orthogonal to
//! it. The distance is `d = atan2(√(b² + r²), |a|)`. With `φ = d / sin d` the square `h = d²` has
//!
//! ```text
//! dh/dθ = −2 φ b sign a,    d²h/dθ² / 2 = D + (1 − D) φ |a|,    D = b² / sin² d.
//! ```
//!
//! The squared chord `h = 2 (1 − |a|)` has `φ = 1` and `d²h/dθ² / 2 = |a|`. A missing sample is stored as four zeros,
//! for which all of these are 0.

use super::poses::{Lane, Part, TILE, Tile};
use crate::Real;
use crate::simd::multiversion;

/// A sample relative to a point of a geodesic.
#[derive(Debug, Clone, Copy)]
pub(super) struct View {
    /// `h`.
    pub(super) square: f64,
    /// `φ sign a`.
    pub(super) factor: f64,
    /// `b`.
    pub(super) along: f64,
    /// `d²h/dθ² / 2`.
    pub(super) bend: f64,
    /// `sin θ / θ`.
    pub(super) sinc: f64,
}

/// Sums over the joints, for each pose.
#[derive(Debug, Clone)]
pub(super) struct Sums {
    /// `h`.
    pub(super) square: Lane,
    /// `Σ n φ b sign a`, minus half the derivative by `s`.
    pub(super) pull: Lane,
    /// Half the second derivative by `s`.
    pub(super) bend: Lane,
}

/// Values of a joint that the gradient needs: `φ sign a`, `b`, `sin θ / θ`.
pub(super) type Kept = [Lane; 3];

/// A sample relative to a point; `sign` overrides the sign of `a`.
#[inline(always)]
pub(super) fn view<const CHORDAL: bool>(x: [f64; 4], part: Part, s: f64, sign: Option<f64>) -> View {
    let theta = s * part.length;
    let (sin, cos) = Real::sin_cos(theta);
    let e = part.axis;
    let p = x[1] * e[0] + x[2] * e[1] + x[3] * e[2];
    let across = [x[1] - p * e[0], x[2] - p * e[1], x[3] - p * e[2]];
    let turned = x[0] * cos + p * sin;
    let along = p * cos - x[0] * sin;
    let sign = sign.unwrap_or_else(|| 1.0_f64.copysign(turned));
    let a = turned * sign;
    let square = across[0] * across[0] + across[1] * across[1] + across[2] * across[2] + along * along;
    let sinc = if theta == 0.0 { 1.0 } else { sin / theta };
    if CHORDAL {
        return View { square: 2.0 * square / (1.0 + a), factor: sign, along, bend: a, sinc };
    }
    let sine = square.sqrt();
    let d = sine.atan2_nonnegative(a);
    let inverse = 1.0 / (square + f64::TINY_SQUARE).sqrt();
    let phi = if sine > 0.0 { d * inverse } else { 1.0 };
    let share = along * along * inverse * inverse;
    View { square: d * d, factor: phi * sign, along, bend: share + (1.0 - share) * phi * a, sinc }
}

multiversion! {
    /// Adds pulls and bends at `s` as if no joint had a kink: as if each `a` were above 0.
    pub(super) fn add_views(tile: &Tile, v: &[Part], s: &Lane, chordal: bool, sums: &mut Sums) {
        if chordal {
            add::<true>(tile, v, s, sums);
        } else {
            add::<false>(tile, v, s, sums);
        }
    }
}

#[inline(always)]
fn add<const CHORDAL: bool>(tile: &Tile, v: &[Part], s: &Lane, sums: &mut Sums) {
    for part in v {
        let [w, x, y, z] = &tile[part.joint];
        for i in 0..TILE {
            let seen = view::<CHORDAL>([w.0[i], x.0[i], y.0[i], z.0[i]], *part, s.0[i], Some(1.0));
            sums.pull.0[i] += part.length * (seen.factor * seen.along);
            sums.bend.0[i] += part.length * part.length * seen.bend;
        }
    }
}

multiversion! {
    /// Squares and pulls at `s`, and the values that the gradient needs.
    pub(super) fn keep_views(
        tile: &Tile,
        v: &[Part],
        s: &Lane,
        chordal: bool,
        sums: &mut Sums,
        kept: &mut [Kept],
    ) {
        if chordal {
            keep::<true>(tile, v, s, sums, kept);
        } else {
            keep::<false>(tile, v, s, sums, kept);
        }
    }
}

#[inline(always)]
fn keep<const CHORDAL: bool>(tile: &Tile, v: &[Part], s: &Lane, sums: &mut Sums, kept: &mut [Kept]) {
    for (part, [factor, along, sinc]) in v.iter().zip(kept) {
        let [w, x, y, z] = &tile[part.joint];
        for i in 0..TILE {
            let seen = view::<CHORDAL>([w.0[i], x.0[i], y.0[i], z.0[i]], *part, s.0[i], None);
            sums.square.0[i] += seen.square;
            sums.pull.0[i] += part.length * (seen.factor * seen.along);
            factor.0[i] = seen.factor;
            along.0[i] = seen.along;
            sinc.0[i] = seen.sinc;
        }
    }
}

impl Sums {
    pub(super) const ZERO: Self = Self { square: Lane::ZERO, pull: Lane::ZERO, bend: Lane::ZERO };
}
