//! Principal geodesics: compression to a tolerance, segmentation.

use quatfilt_benches::clips;
use quatfilt_benches::timer::Timer;
use quatfilt_core::geodesics::compress::{Compress, Stored, decompress, principal_frames};
use quatfilt_core::geodesics::segment::Segment;
use quatfilt_core::parallel::Interrupt;
use quatfilt_core::{ClipMut, ClipView, Error};

/// Radians: 0.1°.
const TOLERANCE: f64 = 0.001_745;

fn main() -> Result<(), Error> {
    let mut timer = Timer::new();
    for size in timer.sizes(&[1_000, 10_000]) {
        compression::<f32>(&mut timer, size)?;
        compression::<f64>(&mut timer, size)?;
        segmentation::<f32>(&mut timer, size)?;
    }
    Ok(())
}

fn compression<T: Stored>(timer: &mut Timer, size: (usize, usize)) -> Result<(), Error> {
    let (frames, joints) = size;
    let q = clips::rotations::<T>(frames, joints, 1)?;
    let clip = ClipView::new(&q, frames, joints)?;
    let interrupt = Interrupt::new();
    timer.levels::<T, _, _>("geodesics/principal_frames", size, || principal_frames(clip, &interrupt))?;
    let compress = Compress {
        frames: principal_frames(clip, &interrupt)?,
        tolerance: vec![TOLERANCE; joints],
        quantised: true,
    };
    timer.levels::<T, _, _>("geodesics/compress", size, || compress.compress(clip, &interrupt))?;
    let (stream, _) = compress.compress(clip, &interrupt)?;
    let mut back = vec![T::ZERO; q.len()];
    timer.levels::<T, _, _>("geodesics/decompress", size, || {
        decompress(&stream, ClipMut::new(&mut back, frames, joints)?, &interrupt)
    })
}

fn segmentation<T: Stored>(timer: &mut Timer, size: (usize, usize)) -> Result<(), Error> {
    let (frames, joints) = size;
    let q = clips::rotations::<T>(frames, joints, 1)?;
    let clip = ClipView::new(&q, frames, joints)?;
    let interrupt = Interrupt::new();
    let segment = Segment { components: 1, window: 240, min_length: 120, lag: 60, threshold: 3.0 };
    timer.levels::<T, _, _>("geodesics/segment", size, || segment.segment(clip, &interrupt))
}
