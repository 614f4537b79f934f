//! Motion from a few trajectories: the models of the next pose.

use quatfilt_benches::clips;
use quatfilt_benches::timer::Timer;
use quatfilt_core::parallel::Interrupt;
use quatfilt_core::reconstruction::local_models::{Model, Neighbors, Options, predict_pose};
use quatfilt_core::{Error, Real};

/// Poses before the next one.
const ORDER: usize = 3;

/// Frames of the clip from one example to the next.
const APART: usize = 8;

fn main() -> Result<(), Error> {
    let mut timer = Timer::new();
    let models = [
        ("local_regression", Model::LocalRegression),
        ("local_pcr", Model::LocalPcr),
        ("local_pca", Model::LocalPca),
        ("mean_pose", Model::MeanPose),
    ];
    for (name, model) in models {
        for size in timer.sizes(&[64]) {
            predictions::<f32>(&mut timer, name, model, size)?;
        }
    }
    Ok(())
}

/// One prediction from as many neighbours as `size` has frames.
fn predictions<T: Real>(
    timer: &mut Timer,
    name: &str,
    model: Model,
    size: (usize, usize),
) -> Result<(), Error> {
    let (count, joints) = size;
    let clip = clips::rotations::<T>(count * APART, joints, 1)?;
    let pose = joints * 4;
    let segment = |start: usize, frames: usize| &clip[start * pose..(start + frames) * pose];
    let segments: Vec<T> = (0..count).flat_map(|k| segment(k * APART, ORDER + 1)).copied().collect();
    let root_steps = vec![T::ONE; count * 4];
    let neighbors = Neighbors {
        segments: &segments,
        root_steps: &root_steps,
        count,
        frames: ORDER + 1,
        joints,
        roots: 4,
    };
    let options = Options { model, ..Options::default() };
    let weights = vec![1.0; joints];
    let interrupt = Interrupt::new();
    let recent = segment(APART / 2, ORDER);
    timer.levels::<T, _, _>(&format!("reconstruction/{name}"), size, || {
        predict_pose(&neighbors, recent, &weights, &options, &interrupt)
    })
}
