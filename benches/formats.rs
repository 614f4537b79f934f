//! Formats: BVH text to values and back.

use quatfilt_benches::clips;
use quatfilt_benches::timer::Timer;
use quatfilt_core::parallel;
use quatfilt_formats::bvh::{self, FrameTime};
use quatfilt_formats::{Error, Precision};

fn main() -> Result<(), Error> {
    let mut timer = Timer::new();
    for size in timer.sizes(&[1_000, 20_000]) {
        bvh_text(&mut timer, size)?;
    }
    Ok(())
}

fn bvh_text(timer: &mut Timer, size: (usize, usize)) -> Result<(), Error> {
    let (frames, joints) = size;
    let hierarchy = clips::bvh_joints(joints);
    let values = clips::bvh_values(frames, joints, 1);
    let frame_time = FrameTime::new(1.0 / 120.0);
    let write = |precision| bvh::write(&hierarchy, &frame_time, &values, precision);
    let text = write(Precision::Shortest)?;
    timer.threads::<f64, _, _>("formats/bvh/read", size, || parallel::install(|| bvh::parse(&text)))?;
    for (name, precision) in [("shortest", Precision::Shortest), ("6 decimals", Precision::Decimals(6))] {
        timer.threads::<f64, _, _>(&format!("formats/bvh/write/{name}"), size, || {
            parallel::install(|| write(precision))
        })?;
    }
    Ok(())
}
