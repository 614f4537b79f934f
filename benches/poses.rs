//! Whole poses: principal geodesics of the body.

use quatfilt_benches::clips;
use quatfilt_benches::timer::Timer;
use quatfilt_core::geodesics::body::{body_geodesics, body_product, body_scores};
use quatfilt_core::geodesics::pga::{Objective, Params, geodesic_centre};
use quatfilt_core::parallel::Interrupt;
use quatfilt_core::{ClipView, Error, Real};

/// Geodesics that are fitted.
const COMPONENTS: usize = 5;

fn main() -> Result<(), Error> {
    let mut timer = Timer::new();
    for size in timer.sizes(&[1_000, 10_000]) {
        body::<f32>(&mut timer, size)?;
        body::<f64>(&mut timer, size)?;
    }
    Ok(())
}

fn body<T: Real>(timer: &mut Timer, size: (usize, usize)) -> Result<(), Error> {
    let (frames, joints) = size;
    let q = clips::rotations::<T>(frames, joints, 1)?;
    let clip = ClipView::new(&q, frames, joints)?;
    let interrupt = Interrupt::new();
    let means: Vec<T> =
        geodesic_centre(clip, &interrupt)?.iter().flat_map(|centre| centre.mean.map(T::from_f64)).collect();
    let params =
        Params { components: COMPONENTS, most: COMPONENTS, objective: Objective::Geodesic, tolerance: 0.0 };
    let found = body_geodesics(clip, &means, params, &interrupt)?;
    let directions: Vec<T> =
        found.iter().flat_map(|component| component.direction.iter().map(|&x| T::from_f64(x))).collect();
    let mut scores = vec![T::ZERO; frames * COMPONENTS];
    let mut poses = vec![T::ZERO; q.len()];
    timer.threads::<T, _, _>("geodesics/body_geodesics", size, || {
        body_geodesics(clip, &means, params, &interrupt)
    })?;
    timer.threads::<T, _, _>("geodesics/body_scores", size, || {
        body_scores(clip, &means, &directions, &mut scores, &interrupt)
    })?;
    timer.threads::<T, _, _>("geodesics/body_product", size, || {
        body_product(&scores, &means, &directions, &mut poses, &interrupt)
    })
}
