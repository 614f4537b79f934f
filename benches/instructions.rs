//! One kernel on one thread, to count its instructions with callgrind: `instructions KERNEL REPETITIONS`.
//!
//! The count of three repetitions less that of one is that of two, without start-up and without making the clip.
//! A kernel's name ends in its dtype: `log-f32`. The clip has [`FRAMES`] frames of 31 joints.

use quatfilt_benches::clips::{self, JOINTS};
use quatfilt_benches::settings;
use quatfilt_core::filters::nonlocal_pose_means::{Chart, NonlocalPoseMeans, Weights};
use quatfilt_core::noise::noise;
use quatfilt_core::parallel::{self, Interrupt};
use quatfilt_core::rotations::{mean, quaternion};
use quatfilt_core::search::patch_neighbors::PatchNeighbors;
use quatfilt_core::{ClipMut, ClipView, Real};
use quatfilt_formats::Precision;
use quatfilt_formats::bvh::{self, FrameTime};
use std::error;
use std::hint::black_box;

/// Frames of the clip; instructions.py knows the number too.
const FRAMES: usize = 2_000;

fn main() -> Result<(), Box<dyn error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [kernel, repetitions] = &arguments[..] else {
        return Err("expected: instructions KERNEL REPETITIONS".into());
    };
    let repetitions = repetitions.parse()?;
    parallel::set_num_threads(1);
    match kernel.rsplit_once('-') {
        Some(("bvh", direction)) => text(direction, repetitions),
        Some((kernel, "f32")) => numbers::<f32>(kernel, repetitions),
        Some((kernel, "f64")) => numbers::<f64>(kernel, repetitions),
        _ => Err(format!("kernel: expected a name and a dtype such as log-f32, got {kernel}").into()),
    }
}

fn repeat<E>(repetitions: usize, mut work: impl FnMut() -> Result<(), E>) -> Result<(), E> {
    (0..repetitions).try_for_each(|_| work())
}

fn numbers<T: Real>(kernel: &str, repetitions: usize) -> Result<(), Box<dyn error::Error>> {
    let q = clips::rotations::<T>(FRAMES, JOINTS, 1)?;
    let clip = ClipView::new(&q, FRAMES, JOINTS)?;
    let mut out = vec![T::ZERO; q.len()];
    let mut vectors = vec![T::ZERO; FRAMES * JOINTS * 3];
    let mut numbers = vec![T::ZERO; FRAMES * JOINTS];
    let interrupt = Interrupt::new();
    quaternion::log(&q, &mut vectors)?;
    match kernel {
        "log" => repeat(repetitions, || quaternion::log(&q, &mut vectors))?,
        "exp" => repeat(repetitions, || quaternion::exp(&vectors, &mut out))?,
        "multiply" => repeat(repetitions, || quaternion::multiply(&q, &q, &mut out))?,
        "geodesic_distance" => {
            repeat(repetitions, || quaternion::geodesic_distance(&q, &q, &mut numbers))?;
        }
        "mean" => repeat(repetitions, || mean::mean(clip, None, &interrupt).map(|_| ()))?,
        "noise_level" => repeat(repetitions, || noise::noise_level(clip, &mut numbers[..JOINTS]))?,
        "patch_neighbors" => {
            let search =
                PatchNeighbors { patch_radius: 5, count: 16, exclusion: 5, weights: vec![1.0; JOINTS] };
            let mut indices = vec![0; FRAMES * search.count];
            let distances = &mut numbers[..FRAMES * search.count];
            repeat(repetitions, || search.search(clip, None, &mut indices, distances, &interrupt))?;
        }
        _ => {
            let filter = filter(kernel)?;
            repeat(repetitions, || {
                let out = ClipMut::new(&mut out, clip.frames(), clip.joints())?;
                filter.filter(clip, None, None, None, out, &interrupt)
            })?;
        }
    }
    black_box((&out, &vectors, &numbers));
    Ok(())
}

fn filter(kernel: &str) -> Result<NonlocalPoseMeans, String> {
    let default = settings::nonlocal_pose_means(JOINTS);
    match kernel {
        "nlpm" => Ok(default),
        "nlpm_local" => Ok(NonlocalPoseMeans { chart: Chart::Local, ..default }),
        "nlpm_joint" => Ok(NonlocalPoseMeans { weights: Weights::Joint, ..default }),
        _ => Err(format!("kernel: unknown name {kernel}")),
    }
}

fn text(direction: &str, repetitions: usize) -> Result<(), Box<dyn error::Error>> {
    let joints = clips::bvh_joints(JOINTS);
    let values = clips::bvh_values(FRAMES, JOINTS, 1);
    let frame_time = FrameTime::new(1.0 / 120.0);
    let written = bvh::write(&joints, &frame_time, &values, Precision::Shortest)?;
    match direction {
        "read" => repeat(repetitions, || bvh::parse(&written).map(|_| ()))?,
        "write" => repeat(repetitions, || {
            bvh::write(&joints, &frame_time, &values, Precision::Shortest).map(|_| ())
        })?,
        _ => return Err(format!("bvh: expected read or write, got {direction}").into()),
    }
    Ok(())
}
