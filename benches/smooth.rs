//! Automatic smoothing.

use quatfilt_benches::clips;
use quatfilt_benches::timer::Timer;
use quatfilt_core::filters::orientation_filter::OrientationFilter;
use quatfilt_core::filters::smooth::{Noisy, smooth_patches};
use quatfilt_core::parallel::Interrupt;
use quatfilt_core::window::Boundary;
use quatfilt_core::{ClipMut, ClipView, Error, Real};

fn main() -> Result<(), Error> {
    let mut timer = Timer::new();
    for size in timer.sizes(&[1_500, 10_000]) {
        patches::<f32>(&mut timer, size)?;
        patches::<f64>(&mut timer, size)?;
    }
    Ok(())
}

/// One round of the non-local step, with a moving mean as pilot.
fn patches<T: Real>(timer: &mut Timer, size: (usize, usize)) -> Result<(), Error> {
    let (frames, joints) = size;
    let q = clips::rotations::<T>(frames, joints, 1)?;
    let clip = ClipView::new(&q, frames, joints)?;
    let interrupt = Interrupt::new();
    let mut pilot = vec![T::ZERO; q.len()];
    OrientationFilter { mask: vec![1.0; 9], iterations: 1, boundary: Boundary::Mirror }.filter(
        clip,
        None,
        ClipMut::new(&mut pilot, frames, joints)?,
        &interrupt,
    )?;
    let pilot = ClipView::new(&pilot, frames, joints)?;
    let mut out = vec![T::ZERO; q.len()];
    let noisy = Noisy { clip, pilot, confidence: None, noise: &vec![clips::NOISE; joints] };
    timer.levels::<T, _, _>("filters/smooth_patches", size, || {
        smooth_patches(&noisy, 1, ClipMut::new(&mut out, frames, joints)?, &interrupt)
    })
}
