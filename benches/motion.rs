//! Motion: forward kinematics, and feet on the ground.

use quatfilt_benches::clips;
use quatfilt_benches::timer::Timer;
use quatfilt_core::motion::feet::{self, Body, Displacements, FootPaths, Placed};
use quatfilt_core::motion::skeleton::{self, Tree};
use quatfilt_core::parallel::Interrupt;
use quatfilt_core::{ClipView, Error, Real};

fn main() -> Result<(), Error> {
    let mut timer = Timer::new();
    for size in timer.sizes(&[1_000, 100_000]) {
        forward_kinematics::<f32>(&mut timer, size)?;
        forward_kinematics::<f64>(&mut timer, size)?;
        foot_displacements::<f32>(&mut timer, size)?;
        place_feet::<f32>(&mut timer, size)?;
    }
    Ok(())
}

fn forward_kinematics<T: Real>(timer: &mut Timer, size: (usize, usize)) -> Result<(), Error> {
    let (frames, joints) = size;
    let q = clips::rotations::<T>(frames, joints, 1)?;
    let clip = ClipView::new(&q, frames, joints)?;
    let translation = vec![T::ONE; frames * 3];
    let parents = clips::parents(joints);
    let offsets = vec![T::ONE; joints * 3];
    let tree = Tree { parents: &parents, offsets: &offsets };
    let mut out = vec![T::ZERO; frames * joints * 3];
    timer.levels::<T, _, _>("motion/forward_kinematics", size, || {
        skeleton::forward_kinematics(clip, &translation, tree, &mut out)
    })
}

/// Joints of two feet.
const FEET: usize = 4;

/// Two feet that step forward once per second, with a trace of noise before the filter.
fn foot_displacements<T: Real>(timer: &mut Timer, (frames, _): (usize, usize)) -> Result<(), Error> {
    let step = |t: usize| ((t % 120) as f64 / 60.0 - 1.0).max(0.0);
    let path = |noise: f64| -> Vec<T> {
        let point = |at: usize| {
            let (t, foot) = (at / FEET, at % FEET);
            let phase = t + 60 * (foot / 2);
            let wobble = noise * ((at * 7919 % 201) as f64 / 100.0 - 1.0);
            [(phase / 120) as f64 * 100.0 + 100.0 * step(phase), 10.0 * step(phase) + wobble, wobble]
        };
        (0..frames * FEET).flat_map(point).map(T::from_f64).collect()
    };
    let (before, after) = (path(0.3), path(0.02));
    let mut displacements = vec![0.0; frames * FEET * 3];
    let mut contacts = vec![false; frames * FEET];
    let paths = FootPaths {
        before: &before,
        after: &after,
        lengths: &[90.0, 90.0],
        up: 1,
        down: false,
        fps: 120.0,
        contacts: None,
        lock: false,
    };
    timer.levels::<T, _, _>("motion/foot_displacements", (frames, FEET), || {
        let out = Displacements { displacements: &mut displacements, contacts: &mut contacts };
        feet::foot_displacements(paths, out, &Interrupt::new())
    })
}

/// A body on two legs whose feet are to be moved in every frame.
fn place_feet<T: Real>(timer: &mut Timer, (frames, _): (usize, usize)) -> Result<(), Error> {
    const PARENTS: [Option<usize>; 9] =
        [None, Some(0), Some(1), Some(2), Some(3), Some(0), Some(5), Some(6), Some(7)];
    let joints = PARENTS.len();
    let q = clips::rotations::<T>(frames, joints, 1)?;
    let translation = vec![T::ONE; frames * 3];
    let local: Vec<T> = (0..joints * 3).map(|i| T::from_f64(if i % 3 == 1 { -43.0 } else { 2.0 })).collect();
    let displacements = vec![0.5; frames * FEET * 3];
    let mut rotations = vec![T::ZERO; q.len()];
    let mut moved = vec![T::ZERO; frames * 3];
    let body = Body {
        rotations: ClipView::new(&q, frames, joints)?,
        translation: &translation,
        local: &local,
        parents: &PARENTS,
        pelvis: 0,
        legs: &[[1, 2, 3, 4], [5, 6, 7, 8]],
        lengths: &[86.0, 86.0],
        displacements: &displacements,
        root: true,
        lock: false,
    };
    timer.levels::<T, _, _>("motion/place_feet", (frames, joints), || {
        let out = Placed { rotations: &mut rotations, translation: &mut moved };
        feet::place_feet(body, out, &Interrupt::new())
    })
}
