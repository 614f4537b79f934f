//! Agreement with glam, whose quaternions are scalar last.

use glam::{DQuat, DVec3, Quat, Vec3};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use quatfilt_core::rotations::quaternion::{angle_between, between, exp_one, log_short, product, unit};

/// Largest difference of components near 1: a few roundings.
const CLOSE: f64 = 4.0 * f64::EPSILON;
const CLOSE_32: f32 = 4.0 * f32::EPSILON;

/// The same cases on every run, and nothing written beside the sources.
fn cases() -> ProptestConfig {
    ProptestConfig {
        cases: 2000,
        rng_seed: RngSeed::Fixed(1),
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

fn quaternion() -> impl Strategy<Value = [f64; 4]> {
    prop::array::uniform4(-1.0..1.0)
        .prop_filter("away from zero", |q| q.iter().map(|x| x * x).sum::<f64>() > 0.01)
        .prop_map(unit)
}

fn wide(q: [f64; 4]) -> DQuat {
    DQuat::from_xyzw(q[1], q[2], q[3], q[0])
}

fn narrow(q: [f64; 4]) -> [f32; 4] {
    #[expect(clippy::cast_possible_truncation, reason = "rounding is what is asked for")]
    q.map(|x| x as f32)
}

fn short(q: [f32; 4]) -> Quat {
    Quat::from_xyzw(q[1], q[2], q[3], q[0])
}

fn apart(a: [f64; 4], b: DQuat) -> f64 {
    (wide(a) - b).to_array().into_iter().fold(0.0, |worst, x| f64::max(worst, x.abs()))
}

fn apart_32(a: [f32; 4], b: Quat) -> f32 {
    (short(a) - b).to_array().into_iter().fold(0.0, |worst, x| f32::max(worst, x.abs()))
}

proptest! {
    #![proptest_config(cases())]

    #[test]
    fn products(a in quaternion(), b in quaternion()) {
        prop_assert!(apart(product(a, b), wide(a) * wide(b)) <= CLOSE);
        prop_assert!(apart(between(a, b), wide(a).conjugate() * wide(b)) <= CLOSE);
        let (a, b) = (narrow(a), narrow(b));
        prop_assert!(apart_32(product(a, b), short(a) * short(b)) <= CLOSE_32);
    }

    #[test]
    fn units(q in prop::array::uniform4(0.1..10.0)) {
        prop_assert!(apart(unit(q), wide(q).normalize()) <= CLOSE);
        prop_assert!(apart_32(unit(narrow(q)), short(narrow(q)).normalize()) <= CLOSE_32);
    }

    #[test]
    fn exponentials(v in prop::array::uniform3(-1.5..1.5)) {
        prop_assert!(apart(exp_one(v), DQuat::from_scaled_axis(DVec3::from_array(v) * 2.0)) <= CLOSE);
        let [_, x, y, z] = narrow([0.0, v[0], v[1], v[2]]);
        prop_assert!(apart_32(exp_one([x, y, z]), Quat::from_scaled_axis(Vec3::new(x, y, z) * 2.0)) <= CLOSE_32);
    }

    #[test]
    fn logarithms(v in prop::array::uniform3(-0.8..0.8)) {
        // glam's own arc cosine loses digits near the identity.
        let q = exp_one(v);
        let ours = DVec3::from_array(log_short(q)) * 2.0;
        prop_assert!((ours - wide(q).to_scaled_axis()).length() <= 1e-12);
    }

    #[test]
    fn angles(a in quaternion(), b in quaternion()) {
        // glam takes the arc cosine: half of the digits are left where the angle is small.
        let theirs = wide(a).angle_between(wide(b));
        prop_assert!((angle_between(a, b) - theirs).abs() <= 1e-7);
    }
}
