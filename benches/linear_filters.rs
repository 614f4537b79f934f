//! Filters for numbers on rotations about a reference path.

use quatfilt_benches::clips;
use quatfilt_benches::timer::Timer;
use quatfilt_core::filters::butterworth::Butterworth;
use quatfilt_core::filters::development::{Input, Smooth};
use quatfilt_core::filters::gaussian::Gaussian;
use quatfilt_core::filters::savgol::Savgol;
use quatfilt_core::filters::weighted_moving_mean::WeightedMovingMean;
use quatfilt_core::parallel::Interrupt;
use quatfilt_core::window::Boundary;
use quatfilt_core::{ClipMut, ClipView, Error, Real};

/// Fourth order, 6 Hz at 120 frames per second: the coefficients of the two sections, and their steady states.
const SECTIONS: [f64; 12] = [
    4.165_992_044_065_993_7e-4,
    8.331_984_088_131_987e-4,
    4.165_992_044_065_993_7e-4,
    1.0,
    -1.479_674_216_931_193_4,
    0.555_821_543_282_488_9,
    1.0,
    2.0,
    1.0,
    1.0,
    -1.700_964_331_943_525_7,
    0.788_499_739_815_297_9,
];
const STATES: [f64; 4] =
    [0.021_467_252_763_536_42, -0.011_746_917_169_381_02, 0.978_116_148_032_055_6, -0.766_615_887_847_353_8];

/// Frames of a Savitzky–Golay window.
const WINDOW: usize = 11;

fn main() -> Result<(), Error> {
    let mut timer = Timer::new();
    for size in timer.sizes(&[1_000, 10_000]) {
        filters::<f32>(&mut timer, size)?;
        filters::<f64>(&mut timer, size)?;
    }
    Ok(())
}

fn filters<T: Real>(timer: &mut Timer, size: (usize, usize)) -> Result<(), Error> {
    let joints = size.1;
    for sigma in [1.0, 3.0, 12.0] {
        let filter = Gaussian { sigma: vec![sigma; joints], boundary: Boundary::Mirror };
        time::<T>(timer, &format!("gaussian/sigma={sigma}"), size, sigma, &filter)?;
    }
    let butterworth = Butterworth {
        sections: SECTIONS.repeat(joints),
        states: STATES.repeat(joints),
        count: 2,
        padding: 15,
    };
    time::<T>(timer, "butterworth", size, 2.6, &butterworth)?;
    // The mean of the window: a polynomial of another degree costs the same but at the ends.
    let savgol = Savgol { window: WINDOW, fit: vec![1.0 / WINDOW as f64; WINDOW], values: vec![1.0; WINDOW] };
    time::<T>(timer, "savgol", size, 1.4, &savgol)?;
    time::<T>(timer, "weighted_moving_mean", size, 1.4, &WeightedMovingMean { iterations: 1 })
}

fn time<T: Real>(
    timer: &mut Timer,
    name: &str,
    size: (usize, usize),
    sigma: f64,
    filter: &impl Smooth,
) -> Result<(), Error> {
    let (frames, joints) = size;
    let q = clips::rotations::<T>(frames, joints, 1)?;
    let reference_sigma = vec![sigma; joints];
    let input = Input {
        clip: ClipView::new(&q, frames, joints)?,
        confidence: None,
        reference_sigma: &reference_sigma,
    };
    let mut out = vec![T::ZERO; q.len()];
    let interrupt = Interrupt::new();
    timer.threads::<T, _, _>(&format!("filters/{name}"), size, || {
        input.filter(filter, None, ClipMut::new(&mut out, frames, joints)?, &interrupt)
    })
}
