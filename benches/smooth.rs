//! Automatic smoothing: each joint by itself, all together, groups of similar patches, low rank, and learned gains.

use quatfilt_benches::clips::{self, NOISE};
use quatfilt_benches::timer::Timer;
use quatfilt_core::filters::development::Input;
use quatfilt_core::filters::smooth::{
    Network, Noisy, REFERENCE_SIGMA, Smoother, smooth_body, smooth_gains, smooth_patches, smooth_rank,
};
use quatfilt_core::parallel::Interrupt;
use quatfilt_core::{ClipMut, ClipView, Error, Real};

fn main() -> Result<(), Error> {
    let mut timer = Timer::new();
    for size in timer.sizes(&[1_000, 10_000]) {
        smooth::<f32>(&mut timer, size)?;
        smooth::<f64>(&mut timer, size)?;
    }
    Ok(())
}

fn smooth<T: Real>(timer: &mut Timer, size: (usize, usize)) -> Result<(), Error> {
    let (frames, joints) = size;
    let q = clips::rotations::<T>(frames, joints, 1)?;
    let clip = ClipView::new(&q, frames, joints)?;
    let noise = vec![NOISE; joints];
    let input = Input { clip, confidence: None, reference_sigma: &vec![REFERENCE_SIGMA; joints] };
    let mut pilot = vec![T::ZERO; q.len()];
    let interrupt = Interrupt::new();
    timer.levels::<T, _, _>("filters/smooth", size, || {
        let smoother = Smoother::new(frames, noise.clone(), 0.0);
        input.filter(&smoother, None, ClipMut::new(&mut pilot, frames, joints)?, &interrupt)
    })?;
    let noisy =
        Noisy { clip, pilot: ClipView::new(&pilot, frames, joints)?, confidence: None, noise: &noise };
    let mut out = vec![T::ZERO; q.len()];
    timer.threads::<T, _, _>("filters/smooth_body", size, || {
        smooth_body(&noisy, ClipMut::new(&mut out, frames, joints)?, &interrupt)
    })?;
    timer.threads::<T, _, _>("filters/smooth_patches", size, || {
        smooth_patches(&noisy, 1, ClipMut::new(&mut out, frames, joints)?, &interrupt)
    })?;
    timer.threads::<T, _, _>("filters/smooth_rank", size, || {
        smooth_rank(&noisy, ClipMut::new(&mut out, frames, joints)?, &interrupt)
    })?;
    // As many weights as the network of the package has.
    let network = Network::new(&vec![0.01; 102 * 64], &vec![0.01; 65 * 64], &vec![0.01; 65 * 19])?;
    timer.threads::<T, _, _>("filters/smooth_gains", size, || {
        smooth_gains(&noisy, clip, 1.0, &network, ClipMut::new(&mut out, frames, joints)?, &interrupt)
    })
}
