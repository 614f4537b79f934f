//! Motion: forward kinematics.

use quatfilt_benches::clips;
use quatfilt_benches::timer::Timer;
use quatfilt_core::motion::skeleton::{self, Tree};
use quatfilt_core::{ClipView, Error, Real};

fn main() -> Result<(), Error> {
    let mut timer = Timer::new();
    for size in timer.sizes(&[1_000, 100_000]) {
        forward_kinematics::<f32>(&mut timer, size)?;
        forward_kinematics::<f64>(&mut timer, size)?;
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
