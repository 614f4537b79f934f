//! Filters that go through time frame by frame: the Kalman filter by what its cost depends on, and the 1€ filter.

use quatfilt_benches::clips::{self, NOISE};
use quatfilt_benches::timer::Timer;
use quatfilt_core::filters::kalman::{self, Kalman};
use quatfilt_core::filters::one_euro::OneEuro;
use quatfilt_core::parallel::Interrupt;
use quatfilt_core::{ClipMut, ClipView, Error, Real};

fn main() -> Result<(), Error> {
    let mut timer = Timer::new();
    for size in timer.sizes(&[1_000, 10_000]) {
        filters::<f32>(&mut timer, size)?;
        filters::<f64>(&mut timer, size)?;
    }
    for size in timer.sizes(&[1_000]) {
        automatic(&mut timer, size)?;
    }
    Ok(())
}

fn filters<T: Real>(timer: &mut Timer, size: (usize, usize)) -> Result<(), Error> {
    let (frames, joints) = size;
    let q = clips::rotations::<T>(frames, joints, 1)?;
    let clip = ClipView::new(&q, frames, joints)?;
    let mut out = vec![T::ZERO; q.len()];
    let interrupt = Interrupt::new();
    for (change, lookahead) in [("smooth", None), ("lookahead=0", Some(0)), ("lookahead=8", Some(8))] {
        let filter = Kalman {
            process_noise: vec![0.1 * NOISE; joints],
            measurement_noise: vec![NOISE; joints],
            lookahead,
        };
        timer.threads::<T, _, _>(&format!("filters/kalman/{change}"), size, || {
            filter.filter(clip, None, ClipMut::new(&mut out, frames, joints)?, &interrupt)
        })?;
    }
    let filter = OneEuro {
        min_cutoff: vec![0.01; joints],
        beta: vec![0.1; joints],
        derivative_cutoff: vec![0.01; joints],
    };
    timer.threads::<T, _, _>("filters/one_euro", size, || {
        filter.filter(clip, None, None, ClipMut::new(&mut out, frames, joints)?, &interrupt)
    })
}

/// The choice of the process noise.
fn automatic(timer: &mut Timer, size: (usize, usize)) -> Result<(), Error> {
    let (frames, joints) = size;
    let q = clips::rotations::<f32>(frames, joints, 1)?;
    let clip = ClipView::new(&q, frames, joints)?;
    let interrupt = Interrupt::new();
    timer.threads::<f32, _, _>("filters/kalman/process_noise", size, || {
        kalman::process_noise(clip, None, &vec![NOISE; joints], frames, None, &interrupt)
    })
}
