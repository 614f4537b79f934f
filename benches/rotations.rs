//! Rotations: algebra, mean, continuity, resampling.

use quatfilt_benches::clips;
use quatfilt_benches::timer::Timer;
use quatfilt_core::parallel::Interrupt;
use quatfilt_core::rotations::{continuity, mean, quaternion, resample};
use quatfilt_core::{ClipMut, ClipView, Error, Real};

fn main() -> Result<(), Error> {
    let mut timer = Timer::new();
    for size in timer.sizes(&[1_000, 100_000]) {
        algebra::<f32>(&mut timer, size)?;
        algebra::<f64>(&mut timer, size)?;
        paths::<f32>(&mut timer, size)?;
        paths::<f64>(&mut timer, size)?;
    }
    Ok(())
}

fn algebra<T: Real>(timer: &mut Timer, size: (usize, usize)) -> Result<(), Error> {
    let (frames, joints) = size;
    let a = clips::rotations::<T>(frames, joints, 1)?;
    let b = clips::rotations::<T>(frames, joints, 2)?;
    let mut vectors = vec![T::ZERO; frames * joints * 3];
    let mut out = vec![T::ZERO; a.len()];
    let mut angles = vec![T::ZERO; frames * joints];
    timer.levels::<T, _, _>("rotations/log", size, || quaternion::log(&a, &mut vectors))?;
    timer.levels::<T, _, _>("rotations/exp", size, || quaternion::exp(&vectors, &mut out))?;
    timer.levels::<T, _, _>("rotations/multiply", size, || quaternion::multiply(&a, &b, &mut out))?;
    timer.levels::<T, _, _>("rotations/geodesic_distance", size, || {
        quaternion::geodesic_distance(&a, &b, &mut angles)
    })
}

fn paths<T: Real>(timer: &mut Timer, size: (usize, usize)) -> Result<(), Error> {
    let (frames, joints) = size;
    let q = clips::rotations::<T>(frames, joints, 1)?;
    let clip = ClipView::new(&q, frames, joints)?;
    let mut out = vec![T::ZERO; q.len()];
    let interrupt = Interrupt::new();
    timer.levels::<T, _, _>("rotations/scan", size, || quaternion::scan(clip))?;
    timer.levels::<T, _, _>("rotations/mean", size, || mean::mean(clip, None, &interrupt))?;
    timer.levels::<T, _, _>("rotations/continuous", size, || {
        continuity::continuous(clip, ClipMut::new(&mut out, frames, joints)?)
    })?;
    let times: Vec<f64> = (0..frames).map(|frame| frame as f64).collect();
    // Between the frames, so that no sample is a copy.
    let new_times: Vec<f64> = times.iter().map(|time| (time + 0.3).min((frames - 1) as f64)).collect();
    timer.levels::<T, _, _>("rotations/slerp", size, || {
        resample::slerp(clip, &times, &new_times, ClipMut::new(&mut out, frames, joints)?)
    })
}
