//! Streams: a clip pushed pose by pose, with a new stream for each.

use quatfilt_benches::clips::{self, NOISE};
use quatfilt_benches::settings;
use quatfilt_benches::timer::Timer;
use quatfilt_core::Error;
use quatfilt_core::filters::bilateral::{Bilateral, Kernel};
use quatfilt_core::filters::kalman::Kalman;
use quatfilt_core::filters::nonlocal_pose_means::{Chart, NonlocalPoseMeans, Weights};
use quatfilt_core::filters::one_euro::OneEuro;
use quatfilt_core::filters::stream::PoseStream;
use quatfilt_core::window::Boundary;

fn main() -> Result<(), Error> {
    let mut timer = Timer::new();
    for size in timer.sizes(&[1_000]) {
        let (frames, joints) = size;
        let q = clips::rotations::<f64>(frames, joints, 1)?;
        let means = |lookahead| NonlocalPoseMeans {
            chart: Chart::Local,
            lookahead: Some(lookahead),
            ..settings::nonlocal_pose_means(joints)
        };
        for (change, filter) in [
            ("lookahead=0", means(0)),
            ("lookahead=10", means(10)),
            ("weights=joint", NonlocalPoseMeans { weights: Weights::Joint, ..means(10) }),
            ("chart=identity", NonlocalPoseMeans { chart: Chart::Identity, ..means(10) }),
        ] {
            timer.levels::<f64, _, _>(&format!("streams/nonlocal_pose_means/{change}"), size, || {
                push(filter.stream()?, &q)
            })?;
        }
        for (change, lookahead, iterations) in [("lookahead=0", 0, 1), ("iterations=5", 4, 5)] {
            let filter = Bilateral {
                radius: 4,
                sigma_time: 1.0,
                sigma_angle: vec![0.2; joints],
                kernel: Kernel::Gaussian,
                iterations,
                boundary: Boundary::Nearest,
                lookahead: Some(lookahead),
            };
            timer.levels::<f64, _, _>(&format!("streams/bilateral/{change}"), size, || {
                push(filter.stream()?, &q)
            })?;
        }
        for (change, lookahead) in [("lookahead=0", 0), ("lookahead=10", 10)] {
            let filter = Kalman {
                process_noise: vec![0.1 * NOISE; joints],
                measurement_noise: vec![NOISE; joints],
                lookahead: Some(lookahead),
            };
            timer.levels::<f64, _, _>(&format!("streams/kalman/{change}"), size, || {
                push(filter.stream()?, &q)
            })?;
        }
        let filter = OneEuro {
            min_cutoff: vec![0.01; joints],
            beta: vec![0.1; joints],
            derivative_cutoff: vec![0.01; joints],
        };
        timer.levels::<f64, _, _>("streams/one_euro", size, || push(filter.stream()?, &q))?;
    }
    Ok(())
}

/// Pushes a clip, and returns a number of all that comes out.
fn push(mut stream: PoseStream, clip: &[f64]) -> Result<f64, Error> {
    let mut sum = 0.0;
    for pose in clip.chunks_exact(stream.joints() * 4) {
        if let Some(came) = stream.push(pose, None)? {
            sum += came[0];
        }
    }
    while let Some(came) = stream.finish() {
        sum += came[0];
    }
    Ok(sum)
}
