//! Largest errors of the elementary functions in units in the last place, against twice the digits of float64.
//!
//! The bounds are those that `elementary.rs` states. `cargo test -p quatfilt-core --test accuracy -- --nocapture`
//! prints what was measured.

mod support;

use quatfilt_core::Real;
use quatfilt_core::rotations::quaternion::{angle_between, exp_one, log_one};
use support::Wide;

/// How many arguments each table takes.
const SAMPLES: u32 = 100_000;

/// A float with its unit in the last place.
trait Float: Real {
    /// The distance between the floats around `x`, not below that at the smallest normal number.
    fn ulp(x: f64) -> f64;
    /// `exp` gives 0 below this.
    const LOWEST_EXPONENT: f64;
}

impl Float for f64 {
    fn ulp(x: f64) -> f64 {
        let exponent = (x.to_bits() >> 52) & 0x7ff;
        f64::from_bits((exponent.max(53) - 52) << 52)
    }
    const LOWEST_EXPONENT: f64 = -708.0;
}

impl Float for f32 {
    fn ulp(x: f64) -> f64 {
        f64::ulp(x.abs().max(f64::from(Self::MIN_POSITIVE))) * 2.0_f64.powi(29)
    }
    const LOWEST_EXPONENT: f64 = -87.0;
}

/// A sequence without gaps or clusters in `[0, 1)`: multiples of the golden ratio.
fn spread() -> impl Iterator<Item = f64> {
    (1..=SAMPLES).map(|i| (f64::from(i) * 0.618_033_988_749_894_9).fract())
}

/// Numbers from `lowest` to `highest`, evenly in their logarithms.
fn magnitudes(lowest: f64, highest: f64) -> impl Iterator<Item = f64> {
    spread().map(move |u| lowest * (highest / lowest).powf(u))
}

fn error<T: Float>(got: T, exact: Wide) -> f64 {
    (Wide::from(got.to_f64()) - exact).high.abs() / T::ulp(exact.high)
}

/// Keeps the largest error and where it was.
struct Worst {
    what: &'static str,
    error: f64,
    at: f64,
}

impl Worst {
    fn new(what: &'static str) -> Self {
        Self { what, error: 0.0, at: 0.0 }
    }

    fn see(&mut self, error: f64, at: f64) {
        // A NaN would be lost in a comparison.
        assert!(error.is_finite(), "{} at {at:e}: {error}", self.what);
        if error > self.error {
            (self.error, self.at) = (error, at);
        }
    }

    #[expect(clippy::print_stdout, reason = "the table that elementary.rs quotes")]
    fn at_most(&self, bound: f64) {
        println!("{:24} {:.3} ulp at {:e}", self.what, self.error, self.at);
        assert!(self.error <= bound, "{}: {} ulp at {:e}", self.what, self.error, self.at);
    }
}

fn exp<T: Float>(what: &'static str) -> Worst {
    let mut worst = Worst::new(what);
    let (low, high) = (T::LOWEST_EXPONENT, T::EXP_LIMIT.to_f64());
    let whole_range = spread().map(|u| low + (high - low) * u);
    let small = magnitudes(1e-18, 2.0).flat_map(|x| [x, -x]);
    for x in whole_range.chain(small) {
        let x = T::from_f64(x);
        if x.to_f64() > low {
            let (exact, power) = Wide::from(x.to_f64()).exp();
            let half = power / 2;
            let got = Real::exp(x).to_f64() * 2.0_f64.powi(-half) * 2.0_f64.powi(half - power);
            let unit = T::ulp(exact.high);
            worst.see((Wide::from(got) - exact).high.abs() / unit, x.to_f64());
        }
    }
    worst
}

/// Errors of sine and cosine in ulp of 1, and of the sine near 0 in its own.
fn sin_cos<T: Float>(what: &'static str) -> [Worst; 2] {
    let (mut absolute, mut relative) = (Worst::new(what), Worst::new("  and small, relative"));
    for x in spread().map(|u| (2.0 * u - 1.0) * std::f64::consts::PI) {
        let x = T::from_f64(x);
        let (sine, cosine) = Real::sin_cos(x);
        let exact = Wide::from(x.to_f64()).sin_cos();
        for (got, exact) in [(sine, exact.0), (cosine, exact.1)] {
            let unit = T::EPSILON.to_f64();
            absolute.see((Wide::from(got.to_f64()) - exact).high.abs() / unit, x.to_f64());
        }
    }
    for x in magnitudes(1e-15, std::f64::consts::FRAC_PI_4).flat_map(|x| [x, -x]) {
        let x = T::from_f64(x);
        relative.see(error(Real::sin_cos(x).0, Wide::from(x.to_f64()).sin_cos().0), x.to_f64());
    }
    [absolute, relative]
}

fn atan2<T: Float>(what: &'static str) -> Worst {
    let mut worst = Worst::new(what);
    let (smallest, largest) = (1e-12, 1e12);
    for ratio in magnitudes(smallest, largest).flat_map(|r| [r, -r]) {
        let (y, x) =
            (T::from_f64(ratio.abs().sqrt()), T::from_f64(1.0 / ratio.abs().sqrt() * ratio.signum()));
        let exact = Wide::atan2(Wide::from(y.to_f64()), Wide::from(x.to_f64()));
        worst.see(error(y.atan2_nonnegative(x), exact), ratio);
    }
    worst
}

/// Unit quaternions, rounded, with angles from tiny to π and axes everywhere.
fn unit_quaternions<T: Float>() -> impl Iterator<Item = [T; 4]> {
    let angles = magnitudes(1e-9, std::f64::consts::PI);
    angles.zip(spread().skip(7)).enumerate().map(|(i, (angle, u))| {
        let angle = if i % 2 == 0 { angle } else { std::f64::consts::PI - angle };
        let (z, turn) = (2.0 * u - 1.0, Wide::from(6.0 * (u * 7919.0).fract() - 3.0).sin_cos());
        let radius = (1.0 - z * z).sqrt();
        let (sine, cosine) = Wide::from(angle).sin_cos();
        let [w, x, y, z] =
            [cosine.high, sine.high * radius * turn.1.high, sine.high * radius * turn.0.high, sine.high * z];
        [w, x, y, z].map(T::from_f64)
    })
}

fn vector_part<T: Real>(q: [T; 4]) -> (Wide, [Wide; 4]) {
    let q = q.map(|x| Wide::from(x.to_f64()));
    ((q[1] * q[1] + q[2] * q[2] + q[3] * q[3]).sqrt(), q)
}

fn distance<T: Real, const N: usize>(got: [T; N], exact: [Wide; N]) -> f64 {
    let square: f64 = got.iter().zip(exact).map(|(g, e)| (Wide::from(g.to_f64()) - e).high.powi(2)).sum();
    square.sqrt()
}

/// Error of the logarithm in ulp of its length.
fn log<T: Float>(what: &'static str) -> Worst {
    let mut worst = Worst::new(what);
    for q in unit_quaternions::<T>() {
        let (sine, [w, x, y, z]) = vector_part(q);
        if sine.high == 0.0 {
            continue;
        }
        let angle = Wide::atan2(sine, w);
        let factor = angle.over(sine);
        let exact = [x * factor, y * factor, z * factor];
        worst.see(distance(log_one(q), exact) / T::ulp(angle.high), angle.high);
    }
    worst
}

/// Error of the exponential in ulp of 1, for half angles up to π.
fn quaternion_exp<T: Float>(what: &'static str) -> Worst {
    let mut worst = Worst::new(what);
    for (q, u) in unit_quaternions::<T>().zip(spread()) {
        let scale = T::from_f64(std::f64::consts::PI * u * u);
        let v = [q[1] * scale, q[2] * scale, q[3] * scale];
        let (angle, [_, x, y, z]) = vector_part([T::ZERO, v[0], v[1], v[2]]);
        if angle.high == 0.0 {
            continue;
        }
        let (sine, cosine) = angle.sin_cos();
        let factor = sine.over(angle);
        let exact = [cosine, x * factor, y * factor, z * factor];
        worst.see(distance(exp_one(v), exact) / T::EPSILON.to_f64(), angle.high);
    }
    worst
}

/// Error of the rotation angle between quaternions, in ulp of 1 and of the angle where that is more than 1.
fn angle<T: Float>(what: &'static str) -> Worst {
    let mut worst = Worst::new(what);
    for (a, b) in unit_quaternions::<T>().zip(unit_quaternions::<T>().skip(13)) {
        let [aw, ax, ay, az] = a.map(|x| Wide::from(x.to_f64()));
        let [bw, bx, by, bz] = b.map(|x| Wide::from(x.to_f64()));
        let w = aw * bw + ax * bx + ay * by + az * bz;
        let x = aw * bx - ax * bw - ay * bz + az * by;
        let y = aw * by + ax * bz - ay * bw - az * bx;
        let z = aw * bz - ax * by + ay * bx - az * bw;
        let sine = (x * x + y * y + z * z).sqrt();
        let w = if w.high < 0.0 { -w } else { w };
        let exact = Wide::atan2(sine, w) * Wide::from(2.0);
        let unit = T::ulp(exact.high.max(1.0));
        worst.see((Wide::from(angle_between(a, b).to_f64()) - exact).high.abs() / unit, exact.high);
    }
    worst
}

/// `(4 asin(√e / 2))²` as `16 atan2(√e / 2, √(1 − e / 4))²`.
fn square_of_angle<T: Float>(what: &'static str) -> Worst {
    let mut worst = Worst::new(what);
    for e in spread().map(|u| 2.0 * u).chain(magnitudes(1e-18, 2.0)) {
        let e = T::from_f64(e);
        let part = Wide::from(e.to_f64()) * Wide::from(0.25);
        let quarter = Wide::atan2(part.sqrt(), (Wide::ONE - part).sqrt());
        worst.see(error(e.square_of_angle(), quarter * quarter * Wide::from(16.0)), e.to_f64());
    }
    worst
}

#[test]
fn the_truth_is_true() {
    let close = |a: Wide, b: Wide| (a - b).high.abs() < 1e-30;
    let ((e, power), (one, power_of_two)) = (Wide::ONE.exp(), Wide::LN_2.exp());
    assert!(close(e * Wide::from(2.0), Wide { high: std::f64::consts::E, low: 1.445_646_891_729_250_2e-16 }));
    assert!(close(one, Wide::ONE));
    assert_eq!((power, power_of_two), (1, 1));
    let (sine, cosine) = Wide::PI.over(Wide::from(6.0)).sin_cos();
    assert!(close(sine, Wide::from(0.5)));
    assert!(close(sine * sine + cosine * cosine, Wide::ONE));
    assert!(close(Wide::atan2(Wide::ONE, Wide::ONE), Wide::PI * Wide::from(0.25)));
    assert!(close(Wide::from(2.0).sqrt() * Wide::from(2.0).sqrt(), Wide::from(2.0)));
}

#[test]
fn exp_is_accurate() {
    exp::<f32>("exp, float32").at_most(2.0);
    exp::<f64>("exp, float64").at_most(2.0);
}

#[test]
fn sine_and_cosine_are_accurate() {
    for worst in sin_cos::<f32>("sin, cos, float32").iter().chain(&sin_cos::<f64>("sin, cos, float64")) {
        worst.at_most(1.0);
    }
}

#[test]
fn atan2_is_accurate() {
    atan2::<f32>("atan2, float32").at_most(3.0);
    atan2::<f64>("atan2, float64").at_most(2.0);
}

#[test]
fn the_logarithm_is_accurate() {
    log::<f32>("log, float32").at_most(4.0);
    log::<f64>("log, float64").at_most(3.0);
}

#[test]
fn the_exponential_is_accurate() {
    quaternion_exp::<f32>("exp of a vector, float32").at_most(4.0);
    quaternion_exp::<f64>("exp of a vector, float64").at_most(4.0);
}

#[test]
fn the_angle_is_accurate() {
    angle::<f32>("angle between, float32").at_most(3.0);
    angle::<f64>("angle between, float64").at_most(3.0);
}

#[test]
fn the_squared_angle_is_accurate() {
    square_of_angle::<f32>("squared angle, float32").at_most(3.0);
    square_of_angle::<f64>("squared angle, float64").at_most(3.0);
}

#[test]
fn exp_ends_in_zero() {
    assert_eq!(Real::exp(-87.5_f32).to_bits(), 0);
    assert_eq!(Real::exp(-708.5_f64).to_bits(), 0);
    assert_eq!(Real::exp(f32::NEG_INFINITY).to_bits(), 0);
    assert_eq!(Real::exp(f64::NEG_INFINITY).to_bits(), 0);
    assert_eq!(Real::exp(0.0_f32).to_bits(), 1.0_f32.to_bits());
    assert_eq!(Real::exp(0.0_f64).to_bits(), 1.0_f64.to_bits());
}

#[test]
fn atan2_at_the_axes() {
    for (y, x, angle) in [(0.0_f64, 1.0, 0.0), (0.0, -1.0, 1.0), (1.0, 0.0, 0.5), (0.0, 0.0, 0.0)] {
        let exact = angle * std::f64::consts::PI;
        assert_eq!(y.atan2_nonnegative(x).to_bits(), exact.to_bits());
        let narrow = (f32::from_f64(y)).atan2_nonnegative(f32::from_f64(x));
        assert_eq!(narrow.to_bits(), f32::from_f64(exact).to_bits());
    }
}
