//! Filters: non-local pose means by what its cost depends on, orientation filters, and gaps.

use quatfilt_benches::clips;
use quatfilt_benches::settings;
use quatfilt_benches::timer::Timer;
use quatfilt_core::filters::bilateral::{Bilateral, Kernel};
use quatfilt_core::filters::confidence;
use quatfilt_core::filters::despike::Despike;
use quatfilt_core::filters::gaps::{self, Method};
use quatfilt_core::filters::nonlocal_pose_means::{Chart, NonlocalPoseMeans, Weights};
use quatfilt_core::filters::orientation_filter::OrientationFilter;
use quatfilt_core::parallel::Interrupt;
use quatfilt_core::window::Boundary;
use quatfilt_core::{ClipMut, ClipView, Error, Real};

fn main() -> Result<(), Error> {
    let mut timer = Timer::new();
    for size in timer.sizes(&[1_000, 10_000, 100_000]) {
        defaults::<f32>(&mut timer, size)?;
        defaults::<f64>(&mut timer, size)?;
    }
    for size in timer.sizes(&[10_000]) {
        variations::<f32>(&mut timer, size)?;
        variations::<f64>(&mut timer, size)?;
        orientation_filters::<f32>(&mut timer, size)?;
        orientation_filters::<f64>(&mut timer, size)?;
        fill_gaps::<f32>(&mut timer, size)?;
        fill_gaps::<f64>(&mut timer, size)?;
        trusted::<f32>(&mut timer, size)?;
        trusted::<f64>(&mut timer, size)?;
        despike::<f32>(&mut timer, size)?;
        despike::<f64>(&mut timer, size)?;
    }
    Ok(())
}

fn defaults<T: Real>(timer: &mut Timer, size: (usize, usize)) -> Result<(), Error> {
    let (frames, joints) = size;
    let q = clips::rotations::<T>(frames, joints, 1)?;
    let clip = ClipView::new(&q, frames, joints)?;
    let mut out = vec![T::ZERO; q.len()];
    let filter = settings::nonlocal_pose_means(joints);
    let interrupt = Interrupt::new();
    timer.levels::<T, _, _>("filters/nonlocal_pose_means", size, || {
        filter.filter(
            clip,
            None,
            None,
            None,
            ClipMut::new(&mut out, clip.frames(), clip.joints())?,
            &interrupt,
        )
    })
}

/// The filter with one thing changed at a time.
fn variations<T: Real>(timer: &mut Timer, size: (usize, usize)) -> Result<(), Error> {
    let (frames, joints) = size;
    let q = clips::rotations::<T>(frames, joints, 1)?;
    let clip = ClipView::new(&q, frames, joints)?;
    let mut out = vec![T::ZERO; q.len()];
    let interrupt = Interrupt::new();
    let default = || settings::nonlocal_pose_means(joints);
    for (change, filter) in [
        ("chart=identity", NonlocalPoseMeans { chart: Chart::Identity, ..default() }),
        ("chart=local", NonlocalPoseMeans { chart: Chart::Local, ..default() }),
        ("weights=joint", NonlocalPoseMeans { weights: Weights::Joint, ..default() }),
        ("neighbors=8", NonlocalPoseMeans { neighbors: Some(8), ..default() }),
        ("search_radius=5", NonlocalPoseMeans { search_radius: Some(5), ..default() }),
        ("search_radius=40", NonlocalPoseMeans { search_radius: Some(40), ..default() }),
        ("patch_radius=0", NonlocalPoseMeans { patch_radius: 0, ..default() }),
        ("patch_radius=50", NonlocalPoseMeans { patch_radius: 50, ..default() }),
    ] {
        timer.threads::<T, _, _>(&format!("filters/nonlocal_pose_means/{change}"), size, || {
            filter.filter(
                clip,
                None,
                None,
                None,
                ClipMut::new(&mut out, clip.frames(), clip.joints())?,
                &interrupt,
            )
        })?;
    }
    Ok(())
}

/// One pass over a window of nine frames: the same mask for all of them, and one of its own for each.
fn orientation_filters<T: Real>(timer: &mut Timer, size: (usize, usize)) -> Result<(), Error> {
    let (frames, joints) = size;
    let q = clips::rotations::<T>(frames, joints, 1)?;
    let clip = ClipView::new(&q, frames, joints)?;
    let mut out = vec![T::ZERO; q.len()];
    let interrupt = Interrupt::new();
    let filter = OrientationFilter { mask: vec![1.0; 9], iterations: 1, boundary: Boundary::Mirror };
    timer.threads::<T, _, _>("filters/orientation_filter", size, || {
        filter.filter(clip, None, ClipMut::new(&mut out, frames, joints)?, &interrupt)
    })?;
    let filter = Bilateral {
        radius: 4,
        sigma_time: 1.0,
        sigma_angle: vec![0.2; joints],
        kernel: Kernel::Gaussian,
        iterations: 1,
        boundary: Boundary::Mirror,
        lookahead: None,
    };
    timer.threads::<T, _, _>("filters/bilateral", size, || {
        filter.filter(clip, None, ClipMut::new(&mut out, frames, joints)?, &interrupt)
    })
}

/// One sample in ten is filled in, one in ten gives way by half.
fn trusted<T: Real>(timer: &mut Timer, size: (usize, usize)) -> Result<(), Error> {
    let (frames, joints) = size;
    let q = clips::rotations::<T>(frames, joints, 1)?;
    let clip = ClipView::new(&q, frames, joints)?;
    let mut out = vec![T::ZERO; q.len()];
    let confidences = [T::ZERO, T::HALF, T::ONE];
    let trust: Vec<T> = (0..frames * joints).map(|i| confidences[(i % 10).min(2)]).collect();
    timer.threads::<T, _, _>("filters/confidence", size, || {
        confidence::pulled_by_confidence(clip, &trust, ClipMut::new(&mut out, frames, joints)?)
    })
}

/// Noise alone, and with one spike in a hundred samples.
fn despike<T: Real>(timer: &mut Timer, size: (usize, usize)) -> Result<(), Error> {
    let (frames, joints) = size;
    let mut q = clips::rotations::<T>(frames, joints, 1)?;
    let mut found = vec![false; frames * joints];
    let interrupt = Interrupt::new();
    let filter = Despike {
        noise: vec![clips::NOISE; joints],
        smallest: vec![0.105; joints],
        radius: 3,
        threshold: 4.0,
        longest: 45,
    };
    for name in ["filters/despike", "filters/despike/spikes"] {
        let clip = ClipView::new(&q, frames, joints)?;
        timer.threads::<T, _, _>(name, size, || filter.rotations(clip, None, &mut found, &interrupt))?;
        for sample in q.chunks_exact_mut(4).skip(50).step_by(100) {
            // Half a turn about the first axis.
            let [w, x, y, z] = [sample[0], sample[1], sample[2], sample[3]];
            sample.copy_from_slice(&[-x, w, z, -y]);
        }
    }
    Ok(())
}

fn fill_gaps<T: Real>(timer: &mut Timer, size: (usize, usize)) -> Result<(), Error> {
    let (frames, joints) = size;
    let q = clips::gappy::<T>(frames, joints, 1)?;
    let clip = ClipView::new(&q, frames, joints)?;
    let mut out = vec![T::ZERO; q.len()];
    let mut filled = vec![false; frames * joints];
    for (name, method) in [("filters/fill_gaps", Method::Slerp), ("filters/fill_gaps/squad", Method::Squad)] {
        timer.threads::<T, _, _>(name, size, || {
            gaps::fill_gaps(clip, None, method, ClipMut::new(&mut out, frames, joints)?, &mut filled)
        })?;
    }
    Ok(())
}
