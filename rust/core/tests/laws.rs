//! Laws of the algebra of rotations, for float32 and float64.

use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use quatfilt_core::Real;
use quatfilt_core::rotations::quaternion::{
    angle_between, between, conjugate_one, dot, exp_one, log_one, log_short, product, unit,
};

/// How many roundings a law may cost, in units of the rounding of 1.
const ROUNDINGS: f64 = 16.0;

/// The same cases on every run, and nothing written beside the sources.
fn cases() -> ProptestConfig {
    ProptestConfig {
        cases: 2000,
        rng_seed: RngSeed::Fixed(1),
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

fn quaternion<T: Real>() -> impl Strategy<Value = [T; 4]> {
    prop::array::uniform4(-1.0..1.0)
        .prop_filter("away from zero", |q| q.iter().map(|x| x * x).sum::<f64>() > 0.01)
        .prop_map(|q| unit(q.map(T::from_f64)))
}

/// Vectors shorter than `longest`, from tiny to long.
fn vector<T: Real>(longest: f64) -> impl Strategy<Value = [T; 3]> {
    let direction = prop::array::uniform3(-1.0..1.0)
        .prop_filter("away from zero", |v| v.iter().map(|x| x * x).sum::<f64>() > 0.01);
    (direction, -12.0..0.0).prop_map(move |(v, exponent)| {
        let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
        v.map(|x| T::from_f64(x / length * longest * 10_f64.powf(exponent)))
    })
}

fn apart<T: Real, const N: usize>(a: [T; N], b: [T; N]) -> f64 {
    a.into_iter().zip(b).fold(0.0, |worst, (a, b)| f64::max(worst, (a - b).abs().to_f64()))
}

fn length<T: Real>(v: [T; 3]) -> f64 {
    v.into_iter().map(|x| x.to_f64().powi(2)).sum::<f64>().sqrt()
}

macro_rules! laws {
    ($room:ident, $T:ty) => {
        mod $room {
            use super::*;

            const CLOSE: f64 = ROUNDINGS * <$T as Real>::EPSILON as f64;

            proptest! {
                #![proptest_config(cases())]

                #[test]
                fn nothing_lies_between_equal_rotations(q in quaternion::<$T>()) {
                    prop_assert!(log_short(between(q, q)).iter().all(|&x| x == 0.0));
                }

                #[test]
                fn exp_undoes_log(q in quaternion::<$T>()) {
                    prop_assert!(apart(exp_one(log_one(q)), q) <= CLOSE);
                }

                #[test]
                fn log_undoes_exp(v in vector::<$T>(3.1)) {
                    // Near π the logarithm turns the rounding of the quaternion into as much of the axis.
                    prop_assert!(apart(log_one(exp_one(v)), v) <= CLOSE * std::f64::consts::PI / (std::f64::consts::PI - length(v)));
                }

                #[test]
                fn the_shorter_logarithm_is_that_of_the_rotation(q in quaternion::<$T>()) {
                    let v = log_short(q);
                    prop_assert!(apart(log_short(q.map(|x| -x)), v) == 0.0 || q[0] == 0.0);
                    prop_assert!(length(v) <= std::f64::consts::FRAC_PI_2 + CLOSE);
                    prop_assert!(angle_between(exp_one(v), q).to_f64() <= CLOSE);
                }

                #[test]
                fn products_associate(
                    a in quaternion::<$T>(), b in quaternion::<$T>(), c in quaternion::<$T>()
                ) {
                    prop_assert!(apart(product(product(a, b), c), product(a, product(b, c))) <= CLOSE);
                }

                #[test]
                fn the_conjugate_is_the_inverse(a in quaternion::<$T>(), b in quaternion::<$T>()) {
                    let one = [1.0, 0.0, 0.0, 0.0];
                    prop_assert!(apart(product(a, conjugate_one(a)), one) <= CLOSE);
                    prop_assert!(apart(conjugate_one(conjugate_one(a)), a) == 0.0);
                    let turned = product(conjugate_one(b), conjugate_one(a));
                    prop_assert!(apart(conjugate_one(product(a, b)), turned) <= CLOSE);
                }

                #[test]
                fn products_keep_lengths(a in quaternion::<$T>(), b in quaternion::<$T>()) {
                    let q = product(a, b);
                    prop_assert!((dot(q, q).to_f64() - 1.0).abs() <= CLOSE);
                }

                #[test]
                fn distance_is_a_metric_of_rotations(
                    a in quaternion::<$T>(), b in quaternion::<$T>(), c in quaternion::<$T>()
                ) {
                    let d = |a, b| angle_between::<$T>(a, b).to_f64();
                    prop_assert!((d(a, b) - d(b, a)).abs() <= CLOSE);
                    prop_assert!(d(a, a) <= CLOSE);
                    prop_assert!((d(a, b.map(|x| -x)) - d(a, b)).abs() <= CLOSE);
                    prop_assert!((0.0..=std::f64::consts::PI + CLOSE).contains(&d(a, b)));
                    prop_assert!(d(a, c) <= d(a, b) + d(b, c) + CLOSE);
                    prop_assert!((d(product(c, a), product(c, b)) - d(a, b)).abs() <= CLOSE);
                    prop_assert!((d(product(a, c), product(b, c)) - d(a, b)).abs() <= CLOSE);
                }

                #[test]
                fn distance_is_twice_the_logarithm(v in vector::<$T>(1.57)) {
                    let one = [1.0, 0.0, 0.0, 0.0];
                    let angle = angle_between(one, exp_one(v)).to_f64();
                    prop_assert!((angle - 2.0 * length(v)).abs() <= CLOSE * length(v));
                }
            }
        }
    };
}

laws!(float32, f32);
laws!(float64, f64);
