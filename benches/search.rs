//! Search: the most similar patches of every frame.

use quatfilt_benches::clips;
use quatfilt_benches::timer::Timer;
use quatfilt_core::parallel::Interrupt;
use quatfilt_core::search::patch_neighbors::PatchNeighbors;
use quatfilt_core::{ClipView, Error, Real};

fn main() -> Result<(), Error> {
    let mut timer = Timer::new();
    for size in timer.sizes(&[1_000, 10_000]) {
        patch_neighbors::<f32>(&mut timer, size)?;
        patch_neighbors::<f64>(&mut timer, size)?;
    }
    Ok(())
}

fn patch_neighbors<T: Real>(timer: &mut Timer, size: (usize, usize)) -> Result<(), Error> {
    let (frames, joints) = size;
    let q = clips::rotations::<T>(frames, joints, 1)?;
    let clip = ClipView::new(&q, frames, joints)?;
    let search = PatchNeighbors { patch_radius: 5, count: 16, exclusion: 5, weights: vec![1.0; joints] };
    let mut indices = vec![0; frames * search.count];
    let mut distances = vec![T::ZERO; frames * search.count];
    let interrupt = Interrupt::new();
    timer.levels::<T, _, _>("search/patch_neighbors", size, || {
        search.search(clip, None, &mut indices, &mut distances, &interrupt)
    })
}
