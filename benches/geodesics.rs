//! Geodesics: centres, principal geodesics, parameters and rotations of parameters.

use quatfilt_benches::clips;
use quatfilt_benches::timer::Timer;
use quatfilt_core::geodesics::pga::{self, Geodesics, Objective, Params};
use quatfilt_core::parallel::Interrupt;
use quatfilt_core::{ClipView, Error, Real};

/// Geodesics per joint.
const COMPONENTS: usize = 5;

fn main() -> Result<(), Error> {
    let mut timer = Timer::new();
    for size in timer.sizes(&[1_000, 20_000]) {
        analysis::<f32>(&mut timer, size)?;
        analysis::<f64>(&mut timer, size)?;
    }
    Ok(())
}

fn analysis<T: Real>(timer: &mut Timer, size: (usize, usize)) -> Result<(), Error> {
    let (frames, joints) = size;
    let q = clips::rotations::<T>(frames, joints, 1)?;
    let clip = ClipView::new(&q, frames, joints)?;
    let interrupt = Interrupt::new();
    timer.levels::<T, _, _>("geodesics/geodesic_centre", size, || pga::geodesic_centre(clip, &interrupt))?;
    let centres = pga::geodesic_centre(clip, &interrupt)?;
    let means: Vec<T> = centres.iter().flat_map(|centre| centre.mean.map(T::from_f64)).collect();
    let params = Params { components: COMPONENTS, most: 0, objective: Objective::Geodesic, tolerance: 0.0 };
    timer.levels::<T, _, _>("geodesics/principal_geodesics", size, || {
        pga::principal_geodesics(clip, &means, params, &interrupt)
    })?;
    let fitted = pga::principal_geodesics(clip, &means, params, &interrupt)?;
    let directions: Vec<T> =
        fitted.iter().flatten().flat_map(|component| component.direction.map(T::from_f64)).collect();
    let geodesics = Geodesics { means: &means, directions: &directions };
    let mut scores = vec![T::ZERO; frames * joints * COMPONENTS];
    timer.levels::<T, _, _>("geodesics/geodesic_scores", size, || {
        pga::geodesic_scores(clip, geodesics, &mut scores, &interrupt)
    })?;
    let mut out = vec![T::ZERO; q.len()];
    timer.levels::<T, _, _>("geodesics/geodesic_product", size, || {
        pga::geodesic_product(&scores, joints, geodesics, &mut out, &interrupt)
    })
}
