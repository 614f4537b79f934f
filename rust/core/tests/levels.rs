//! Every SIMD level gives the same bits.
//!
//! One test only: the level belongs to the process, and tests of one file run at the same time.

use quatfilt_core::filters::development::Input;
use quatfilt_core::filters::nonlocal_pose_means::{Chart, Distance, NonlocalPoseMeans, Weights};
use quatfilt_core::filters::smooth::{Noisy, REFERENCE_SIGMA, Smoother, smooth_body, smooth_patches};
use quatfilt_core::parallel::Interrupt;
use quatfilt_core::reconstruction::features::pose_features;
use quatfilt_core::rotations::{mean, quaternion};
use quatfilt_core::simd::Level;
use quatfilt_core::window::Boundary;
use quatfilt_core::{ClipMut, ClipView, Error, Real};

/// More than a task, and no multiple of a vector.
const ROWS: usize = 20_011;

type Map<T> = fn(&[T], &mut [T]) -> Result<(), Error>;
type Zip<T> = fn(&[T], &[T], &mut [T]) -> Result<(), Error>;

/// Numbers of many magnitudes and both signs, with zeros, infinities and NaN among them.
fn numbers<T: Real>(length: usize, seed: u64) -> Vec<T> {
    let mut state = seed;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    (0..length)
        .map(|i| match i % 1009 {
            0 => T::ZERO,
            1 => T::nan(),
            2 => T::from_f64(f64::INFINITY),
            3 => T::from_f64(1e-40),
            _ => T::from_f64((2.0 * next() - 1.0) * 10_f64.powf(4.0 * next() - 3.0)),
        })
        .collect()
}

/// A smooth clip with noise, unit quaternions `(frames, joints, 4)`.
fn clip<T: Real>(frames: usize, joints: usize) -> Result<Vec<T>, Error> {
    let noise = numbers::<f64>(frames * joints * 4, 4);
    let path = (0..frames * joints * 4).map(|i| {
        let time = (i / (joints * 4)) as f64 / 20.0;
        let wave = [1.0, 0.5 * (time * (2.0 - time % 2.0)), 0.3 * (time % 1.0), 0.2][i % 4];
        let noise = if noise[i].abs() < 10.0 { noise[i] } else { 0.0 };
        T::from_f64(wave + 0.01 * noise)
    });
    let mut units = vec![T::ZERO; frames * joints * 4];
    quaternion::normalize(&path.collect::<Vec<T>>(), &mut units)?;
    Ok(units)
}

fn filters<T: Real>() -> Result<Vec<(&'static str, Vec<T>)>, Error> {
    let (frames, joints) = (701, 3);
    let q = clip::<T>(frames, joints)?;
    let view = ClipView::new(&q, frames, joints)?;
    let interrupt = Interrupt::new();
    let means: Vec<f64> = mean::mean(view, None, &interrupt)?.into_iter().flatten().collect();
    let mut vectors = vec![T::ZERO; frames * joints * 3];
    pose_features(view, &means, &vec![0.5; joints], &mut vectors)?;
    let means = means.into_iter().map(T::from_f64).collect();
    let mut results = vec![("mean", means), ("pose_features", vectors)];
    for (chart, name) in [(Chart::Mean, "mean"), (Chart::Identity, "identity"), (Chart::Local, "local")] {
        for (weights, neighbors) in [(Weights::Pose, None), (Weights::Joint, None), (Weights::Pose, Some(5))]
        {
            let filter = NonlocalPoseMeans {
                search_radius: Some(10),
                patch_radius: 5,
                bandwidth: vec![0.05; joints],
                distance: Distance::Mean,
                weights,
                neighbors,
                chart,
                boundary: Boundary::Mirror,
                lookahead: None,
            };
            let mut out = vec![T::ZERO; q.len()];
            filter.filter(
                view,
                None,
                None,
                None,
                ClipMut::new(&mut out, view.frames(), view.joints())?,
                &interrupt,
            )?;
            results.push((name, out));
        }
    }
    results.extend(smoothers(view)?);
    Ok(results)
}

/// Automatic smoothing of each joint, and of all together.
fn smoothers<T: Real>(clip: ClipView<'_, T>) -> Result<[(&'static str, Vec<T>); 3], Error> {
    let (frames, joints) = (clip.frames(), clip.joints());
    let interrupt = Interrupt::new();
    let noise = vec![0.05; joints];
    let mut pilot = vec![T::ZERO; clip.data().len()];
    let input = Input { clip, confidence: None, reference_sigma: &vec![REFERENCE_SIGMA; joints] };
    let smoother = Smoother::new(frames, noise.clone(), 0.0);
    input.filter(&smoother, None, ClipMut::new(&mut pilot, frames, joints)?, &interrupt)?;
    let (mut body, mut patches) = (pilot.clone(), pilot.clone());
    let noisy =
        Noisy { clip, pilot: ClipView::new(&pilot, frames, joints)?, confidence: None, noise: &noise };
    smooth_body(&noisy, ClipMut::new(&mut body, frames, joints)?, &interrupt)?;
    smooth_patches(&noisy, 2, ClipMut::new(&mut patches, frames, joints)?, &interrupt)?;
    assert!(body != pilot && patches != pilot);
    Ok([("smooth", pilot), ("smooth_body", body), ("smooth_patches", patches)])
}

fn at_level<T: Real>(level: Level) -> Result<Vec<(&'static str, Vec<u64>)>, Error> {
    assert_eq!(level.set(), level);
    let maps: [(&str, usize, usize, Map<T>); 4] = [
        ("conjugate", 4, 4, quaternion::conjugate),
        ("exp", 3, 4, quaternion::exp),
        ("log", 4, 3, quaternion::log),
        ("normalize", 4, 4, quaternion::normalize),
    ];
    let zips: [(&str, usize, Zip<T>); 2] =
        [("geodesic_distance", 1, quaternion::geodesic_distance), ("multiply", 4, quaternion::multiply)];
    let bits = |numbers: Vec<T>| {
        // NaN is one value: its sign and payload are not part of the result.
        numbers.into_iter().map(T::to_f64).map(|x| if x.is_nan() { u64::MAX } else { x.to_bits() }).collect()
    };
    let mut results = Vec::new();
    for (name, columns_in, columns_out, function) in maps {
        let mut out = vec![T::ZERO; ROWS * columns_out];
        function(&numbers(ROWS * columns_in, 1), &mut out)?;
        results.push((name, bits(out)));
    }
    for (name, columns, function) in zips {
        let mut out = vec![T::ZERO; ROWS * columns];
        function(&numbers(ROWS * 4, 2), &numbers(ROWS * 4, 3), &mut out)?;
        results.push((name, bits(out)));
    }
    results.extend(filters::<T>()?.into_iter().map(|(name, out)| (name, bits(out))));
    Ok(results)
}

fn same_bits<T: Real>() -> Result<(), Error> {
    let expected = at_level::<T>(Level::Baseline)?;
    for level in Level::ALL.into_iter().filter(|&level| level <= Level::detected()) {
        for ((name, got), (_, expected)) in at_level::<T>(level)?.into_iter().zip(&expected) {
            let differ = got.iter().zip(expected).position(|(a, b)| a != b);
            assert_eq!(differ, None, "{name} at {} differs from baseline at this element", level.name());
        }
    }
    Ok(())
}

#[test]
fn every_level_gives_the_same_bits() -> Result<(), Error> {
    same_bits::<f32>()?;
    same_bits::<f64>()?;
    for level in Level::ALL {
        assert!(level.set() <= Level::detected());
    }
    Ok(())
}
