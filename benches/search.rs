//! Search: the most similar patches of every frame; the segments of a database nearest to others, and along a motion.

use quatfilt_benches::clips;
use quatfilt_benches::timer::Timer;
use quatfilt_core::parallel::Interrupt;
use quatfilt_core::search::patch_neighbors::PatchNeighbors;
use quatfilt_core::search::poses::along::Along;
use quatfilt_core::search::poses::graph::{self, Apart, Graph, Neighbors};
use quatfilt_core::search::poses::walk::{Database, Fallback, Walk};
use quatfilt_core::search::poses::{Index, Nearest, Segments, nearest};
use quatfilt_core::{ClipView, Error, Real};

fn main() -> Result<(), Error> {
    let mut timer = Timer::new();
    for size in timer.sizes(&[1_000, 10_000]) {
        patch_neighbors::<f32>(&mut timer, size)?;
        patch_neighbors::<f64>(&mut timer, size)?;
    }
    for size in timer.sizes(&[10_000, 100_000]) {
        poses::<f32>(&mut timer, size)?;
        poses::<f64>(&mut timer, size)?;
    }
    for size in timer.sizes(&[2_000]) {
        neighbor_graph::<f32>(&mut timer, size)?;
        walk::<f32>(&mut timer, size)?;
    }
    Ok(())
}

/// Segments of so many poses.
const LENGTH: usize = 3;

/// Neighbours of a query.
const COUNT: usize = 64;

/// Queries at once.
const BATCH: usize = 64;

/// Which segments are neighbours in a graph, and how many.
const APART: Apart = Apart { exclusion: 15, spacing: 8 };
const DEGREE: usize = 16;

/// The nearest that a walk along a graph goes out from.
const BREADTH: usize = 256;

/// Rows of poses, `(poses, 3 · joints)`.
fn rows<T: Real>((poses, joints): (usize, usize), seed: u64) -> Vec<T> {
    clips::rotation_vectors(poses, joints, seed).into_iter().map(T::from_f64).collect()
}

fn poses<T: Real>(timer: &mut Timer, size: (usize, usize)) -> Result<(), Error> {
    let (poses, joints) = size;
    let features = rows::<T>(size, 1);
    let segments = Segments::new(&features, 3 * joints, &[0, poses], LENGTH, 1)?;
    let path = rows::<T>((100, joints), 1);
    let queries: Vec<&[T]> = path.windows(segments.width()).step_by(segments.dims()).collect();
    let (mut indices, mut distances) = ([0; COUNT], [T::ZERO; COUNT]);
    let interrupt = Interrupt::new();
    timer.levels::<T, _, _>("search/nearest_segments", size, || {
        let out = Nearest { count: COUNT, indices: &mut indices, distances: &mut distances };
        nearest(&segments, None, queries[50], None, out, &interrupt)
    })?;
    let many = queries[..BATCH].concat();
    let (mut all_indices, mut all_distances) = (vec![0; BATCH * COUNT], vec![T::ZERO; BATCH * COUNT]);
    timer.threads::<T, _, _>("search/nearest_segments_of_64", size, || {
        let out = Nearest { count: COUNT, indices: &mut all_indices, distances: &mut all_distances };
        nearest(&segments, None, &many, None, out, &interrupt)
    })?;
    timer.levels::<T, _, _>("search/index", size, || Index::new(&segments, &interrupt))?;
    let index = Index::new(&segments, &interrupt)?;
    let mut along = Along::new(COUNT);
    let mut frame = 0;
    // There and back again, a frame a time.
    timer.levels::<T, _, _>("search/along", size, || {
        frame = (frame + 1) % (2 * queries.len());
        let query = queries[frame.min(2 * queries.len() - 1 - frame)];
        along.next(&segments, &index, query, &(0..0)).map(|best| best.found().len())
    })
}

fn walk<T: Real>(timer: &mut Timer, size: (usize, usize)) -> Result<(), Error> {
    let (poses, joints) = size;
    let features = rows::<T>(size, 1);
    let (starts, interrupt) = ([0, poses], Interrupt::new());
    let single = Segments::new(&features, 3 * joints, &starts, 1, 1)?;
    let (mut indices, mut distances) = (vec![0; poses * DEGREE], vec![T::ZERO; poses * DEGREE]);
    let out = Neighbors { degree: DEGREE, indices: &mut indices, distances: &mut distances };
    graph::neighbors(&single, &Index::new(&single, &interrupt)?, APART, out, &interrupt)?;
    let segments = Segments::new(&features, 3 * joints, &starts, LENGTH, 1)?;
    let index = Index::new(&segments, &interrupt)?;
    let graph = Graph::new(&indices, poses, DEGREE)?;
    let database = Database { segments: &segments, index: &index, graph };
    let path = rows::<T>((100, joints), 1);
    let queries: Vec<&[T]> = path.windows(segments.width()).step_by(segments.dims()).collect();
    let mut walk = Walk::new(COUNT, BREADTH, Fallback { frames: usize::MAX, ratio: f64::INFINITY });
    let mut frame = 0;
    timer.levels::<T, _, _>("search/walk", size, || {
        frame = (frame + 1) % (2 * queries.len());
        let query = queries[frame.min(2 * queries.len() - 1 - frame)];
        walk.next(database, query, &(0..0)).map(|(best, _)| best.found().len())
    })
}

fn neighbor_graph<T: Real>(timer: &mut Timer, size: (usize, usize)) -> Result<(), Error> {
    let (poses, joints) = size;
    let features = rows::<T>(size, 1);
    let segments = Segments::new(&features, 3 * joints, &[0, poses], 1, 1)?;
    let (mut indices, mut distances) = (vec![0; poses * DEGREE], vec![T::ZERO; poses * DEGREE]);
    let interrupt = Interrupt::new();
    timer.levels::<T, _, _>("search/neighbor_graph", size, || {
        let index = Index::new(&segments, &interrupt)?;
        let out = Neighbors { degree: DEGREE, indices: &mut indices, distances: &mut distances };
        graph::neighbors(&segments, &index, APART, out, &interrupt)
    })
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
