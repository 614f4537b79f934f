//! Noise: its level, estimated from a clip.

use quatfilt_benches::clips;
use quatfilt_benches::timer::Timer;
use quatfilt_core::noise::noise;
use quatfilt_core::{ClipView, Error, Real};

fn main() -> Result<(), Error> {
    let mut timer = Timer::new();
    for size in timer.sizes(&[1_000, 100_000]) {
        noise_level::<f32>(&mut timer, size)?;
        noise_level::<f64>(&mut timer, size)?;
    }
    Ok(())
}

fn noise_level<T: Real>(timer: &mut Timer, size: (usize, usize)) -> Result<(), Error> {
    let (frames, joints) = size;
    let q = clips::rotations::<T>(frames, joints, 1)?;
    let clip = ClipView::new(&q, frames, joints)?;
    let mut levels = vec![T::ZERO; joints];
    timer.levels::<T, _, _>("noise/noise_level", size, || noise::noise_level(clip, &mut levels))
}
