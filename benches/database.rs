//! The database of poses: headings, and poses as vectors.

use quatfilt_benches::clips::{self, JOINTS};
use quatfilt_benches::timer::Timer;
use quatfilt_core::reconstruction::{features, heading};
use quatfilt_core::{ClipView, Error, Real};

fn main() -> Result<(), Error> {
    let mut timer = Timer::new();
    for size in timer.sizes(&[1_000, 100_000]) {
        pose_features::<f32>(&mut timer, size)?;
        pose_features::<f64>(&mut timer, size)?;
    }
    for (frames, _) in timer.sizes(&[100_000]) {
        split_heading::<f32>(&mut timer, frames)?;
    }
    Ok(())
}

fn pose_features<T: Real>(timer: &mut Timer, size: (usize, usize)) -> Result<(), Error> {
    let (frames, joints) = size;
    let q = clips::rotations::<T>(frames, joints, 1)?;
    let clip = ClipView::new(&q, frames, joints)?;
    let means = [1.0, 0.0, 0.0, 0.0].repeat(joints);
    let weights = [1.0 / JOINTS as f64].repeat(joints);
    let mut out = vec![T::ZERO; frames * joints * 3];
    timer.levels::<T, _, _>("database/pose_features", size, || {
        features::pose_features(clip, &means, &weights, &mut out)
    })
}

fn split_heading<T: Real>(timer: &mut Timer, frames: usize) -> Result<(), Error> {
    let roots = clips::rotations::<T>(frames, 1, 1)?;
    let (mut headings, mut rest) = (vec![T::ZERO; frames], vec![T::ZERO; roots.len()]);
    timer.threads::<T, _, _>("database/split_heading", (frames, 1), || {
        heading::split_heading(&roots, 1, &mut headings, &mut rest)
    })
}
