//! Mean distance of samples from a geodesic through 1, as a function of its direction.
//!
//! With `p = v·u` a sample `(w, u)` is at the distance `d` from the geodesic with the unit direction `v`, where `cos
//! d = f = √(w² + p²)` and `sin d = |u × v|`. As `v` moves away from `u/|u|` on the sphere of directions, `d` grows
//! with the slope `p/f` and has the curvature `−w² sin d / f³`; orthogonally the curvature is `p²/(f sin d)`.

use super::samples::{LANES, Quad, Samples, cross, dot};
use crate::parallel::Interrupt;
use crate::simd::multiversion;
use crate::{Error, Real};

/// Sine of the distance below which a sample lies on the geodesic.
pub(super) const ON_GEODESIC: f64 = 1e-14;

/// Estimated nanoseconds per sample of a pass for a value, and of a pass for a slope.
const VALUE_NANOSECONDS: usize = 4;
const SLOPE_NANOSECONDS: usize = 10;

/// The objective of a direction: the mean over the samples of a function of the distance `d`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Objective {
    /// `d`: the paper's eq. (9).
    Geodesic,
    /// `d²`.
    Squared,
    /// `1 − cos d`: the objective of the paper's equations (11) and (13).
    Chordal,
}

/// A function of the distance, given as its sine and cosine.
pub(super) trait Shape {
    /// Whether it has a cone point at 0.
    const CONE: bool;

    /// The function.
    fn value(sine: f64, cosine: f64) -> f64;

    /// Its derivative, the derivative over the sine, and its second derivative; `over` is `1/sine`, or 0 at 0.
    fn derivatives(sine: f64, cosine: f64, over: f64) -> [f64; 3];

    /// The largest downward curvature of a sample whose vector part has the length `r`.
    fn bend(w: f64, r: f64) -> f64;

    /// The function at a distance of at least 0.
    fn of_distance(d: f64) -> f64;
}

pub(super) struct Geodesic;
pub(super) struct Squared;
pub(super) struct Chordal;

impl Shape for Geodesic {
    const CONE: bool = true;
    #[inline(always)]
    fn value(sine: f64, cosine: f64) -> f64 {
        sine.atan2_nonnegative(cosine)
    }
    #[inline(always)]
    fn derivatives(_sine: f64, _cosine: f64, over: f64) -> [f64; 3] {
        [if over > 0.0 { 1.0 } else { 0.0 }, over, 0.0]
    }
    #[inline(always)]
    fn bend(w: f64, r: f64) -> f64 {
        r / w
    }
    #[inline(always)]
    fn of_distance(d: f64) -> f64 {
        d
    }
}

impl Shape for Squared {
    const CONE: bool = false;
    #[inline(always)]
    fn value(sine: f64, cosine: f64) -> f64 {
        let d = sine.atan2_nonnegative(cosine);
        d * d
    }
    #[inline(always)]
    fn derivatives(sine: f64, cosine: f64, over: f64) -> [f64; 3] {
        let d = sine.atan2_nonnegative(cosine);
        [2.0 * d, if over > 0.0 { 2.0 * d * over } else { 2.0 }, 2.0]
    }
    #[inline(always)]
    fn bend(w: f64, r: f64) -> f64 {
        2.0 * r.atan2_nonnegative(w) * r / w
    }
    #[inline(always)]
    fn of_distance(d: f64) -> f64 {
        d * d
    }
}

impl Shape for Chordal {
    const CONE: bool = false;
    #[inline(always)]
    fn value(sine: f64, cosine: f64) -> f64 {
        sine * sine / (1.0 + cosine)
    }
    #[inline(always)]
    fn derivatives(sine: f64, cosine: f64, _over: f64) -> [f64; 3] {
        [sine, 1.0, cosine]
    }
    #[inline(always)]
    fn bend(w: f64, r: f64) -> f64 {
        r * r / w
    }
    #[inline(always)]
    fn of_distance(d: f64) -> f64 {
        let (sine, _) = (0.5 * d).sin_cos_real();
        2.0 * sine * sine
    }
}

/// The vectorised sine and cosine under a name that does not clash with the standard library's method.
trait SinCos {
    fn sin_cos_real(self) -> (f64, f64);
}

impl SinCos for f64 {
    #[inline(always)]
    fn sin_cos_real(self) -> (f64, f64) {
        <f64 as Real>::sin_cos(self)
    }
}

/// Calls a kernel for the shape of an objective.
macro_rules! by_shape {
    ($objective:expr, $S:ident => $body:expr) => {
        match $objective {
            $crate::geodesics::pga::objective::Objective::Geodesic => {
                type $S = $crate::geodesics::pga::objective::Geodesic;
                $body
            }
            $crate::geodesics::pga::objective::Objective::Squared => {
                type $S = $crate::geodesics::pga::objective::Squared;
                $body
            }
            $crate::geodesics::pga::objective::Objective::Chordal => {
                type $S = $crate::geodesics::pga::objective::Chordal;
                $body
            }
        }
    };
}
pub(super) use by_shape;

/// Mean over the samples of the objective at a direction.
pub(super) fn value(
    samples: &Samples,
    v: [f64; 3],
    objective: Objective,
    interrupt: &Interrupt,
) -> Result<f64, Error> {
    let [sum] = samples.sums(VALUE_NANOSECONDS, interrupt, |part, sums| {
        by_shape!(objective, S => add_values::<S>(part, v, sums));
    })?;
    Ok(sum / samples.count() as f64)
}

multiversion! {
    fn add_values<S: Shape>(samples: Quad<'_>, v: [f64; 3], sums: &mut [[f64; LANES]; 1]) {
        let total = sums;
        let mut sums = *total;
        let [w, x, y, z] = samples.map(|plane| plane.as_chunks::<LANES>().0);
        for (((w, x), y), z) in w.iter().zip(x).zip(y).zip(z) {
            for c in 0..LANES {
                let (_, sine, cosine) = project([w[c], x[c], y[c], z[c]], v);
                sums[0][c] += S::value(sine, cosine);
            }
        }
        *total = sums;
    }
}

/// `v·u`, and the sine and cosine of the distance from the geodesic.
#[inline(always)]
pub(super) fn project([w, x, y, z]: [f64; 4], v: [f64; 3]) -> (f64, f64, f64) {
    let across = cross([x, y, z], v);
    let p = dot([x, y, z], v);
    (p, dot(across, across).sqrt(), (w * w + p * p).sqrt())
}

/// Two unit vectors orthogonal to the unit vector `v` and to each other.
pub(super) fn basis(v: [f64; 3]) -> [[f64; 3]; 2] {
    let least = (0..3).fold(0, |best, i| if v[i].abs() < v[best].abs() { i } else { best });
    let axis = std::array::from_fn(|i| if i == least { 1.0 } else { 0.0 });
    let first = scaled_to_one(cross(v, axis));
    [first, cross(v, first)]
}

/// The normalised vector.
pub(super) fn scaled_to_one(v: [f64; 3]) -> [f64; 3] {
    let length = dot(v, v).sqrt();
    v.map(|x| x / length)
}

/// An objective at a direction, with its derivatives.
pub(super) struct Slope {
    pub(super) value: f64,
    /// Along the basis; of the samples that are not on the geodesic.
    pub(super) gradient: [f64; 2],
    /// Entries 00, 01 and 11, of the same samples.
    pub(super) hessian: [f64; 3],
    /// Slope of the objective in all directions due to the samples on the geodesic.
    pub(super) cone: f64,
    /// The sample whose direction is nearest.
    pub(super) nearest: Option<usize>,
}

/// Sums of a slope: value, gradient, orthogonal curvature, the 3 other entries of the Hessian, cone.
const SLOPE_SUMS: usize = 8;

/// Objective at `v`, with its gradient and Hessian on the sphere of directions along the basis `across`.
pub(super) fn slope(
    samples: &Samples,
    v: [f64; 3],
    across: [[f64; 3]; 2],
    objective: Objective,
    interrupt: &Interrupt,
) -> Result<Slope, Error> {
    let parts = samples.map(SLOPE_NANOSECONDS, interrupt, |part, start| {
        let mut lanes = [[0.0; LANES]; SLOPE_SUMS];
        let mut away = [[f64::INFINITY; LANES], [-1.0; LANES]];
        by_shape!(objective, S => add_slopes::<S>(part, v, across, &mut lanes, &mut away));
        let best = (0..LANES).fold(0, |best, c| {
            if (away[0][c], away[1][c]) < (away[0][best], away[1][best]) { c } else { best }
        });
        (
            lanes.map(|lanes| lanes.iter().sum::<f64>()),
            away[0][best],
            start + away[1][best].to_count() * LANES + best,
        )
    })?;
    let mut sums = [0.0; SLOPE_SUMS];
    let (mut least, mut nearest) = (f64::INFINITY, None);
    for (part, away, at) in parts {
        sums = std::array::from_fn(|i| sums[i] + part[i]);
        if away < least {
            (least, nearest) = (away, Some(at));
        }
    }
    let [value, g0, g1, over, h00, h01, h11, cone] = sums.map(|sum| sum / samples.count() as f64);
    Ok(Slope { value, gradient: [-g0, -g1], hessian: [h00 + over, h01, h11 + over], cone, nearest })
}

multiversion! {
    fn add_slopes<S: Shape>(
        samples: Quad<'_>,
        v: [f64; 3],
        across: [[f64; 3]; 2],
        sums: &mut [[f64; LANES]; SLOPE_SUMS],
        away: &mut [[f64; LANES]; 2],
    ) {
        let (total, found) = (sums, away);
        let (mut sums, mut away) = (*total, *found);
        let [w, x, y, z] = samples.map(|plane| plane.as_chunks::<LANES>().0);
        let mut row = 0.0;
        for (((w, x), y), z) in w.iter().zip(x).zip(y).zip(z) {
            for c in 0..LANES {
                let u = [x[c], y[c], z[c]];
                let (p, sine, f) = project([w[c], x[c], y[c], z[c]], v);
                let off = sine > ON_GEODESIC;
                let over_sine = if off { 1.0 / sine } else { 0.0 };
                let over_f = 1.0 / f;
                let [first, first_over_sine, second] = S::derivatives(sine, f, over_sine);
                let toward = [dot(u, across[0]) * over_sine, dot(u, across[1]) * over_sine];
                let slope = p * over_f;
                let ratio = w[c] * over_f;
                let along = second * slope * slope - first * sine * ratio * ratio * over_f;
                let over = first_over_sine * p * slope;
                let (rest, pull) = (along - over, first * slope);
                sums[0][c] += S::value(sine, f);
                sums[1][c] += pull * toward[0];
                sums[2][c] += pull * toward[1];
                sums[3][c] += over;
                sums[4][c] += rest * toward[0] * toward[0];
                sums[5][c] += rest * toward[0] * toward[1];
                sums[6][c] += rest * toward[1] * toward[1];
                if S::CONE {
                    sums[7][c] += if off { 0.0 } else { slope.abs() };
                    let square = dot(u, u);
                    let distance = sine * sine / square;
                    // A comparison with NaN is false.
                    let nearer = (square > ON_GEODESIC * ON_GEODESIC) & (distance < away[0][c]);
                    away[0][c] = if nearer { distance } else { away[0][c] };
                    away[1][c] = if nearer { row } else { away[1][c] };
                }
            }
            row += 1.0;
        }
        (*total, *found) = (sums, away);
    }
}
