//! Filters as they are reported.

use crate::clips::NOISE;
use quatfilt_core::filters::nonlocal_pose_means::{Chart, Distance, NonlocalPoseMeans, Weights};
use quatfilt_core::window::Boundary;

/// Non-local pose means with the paper's window of 21 frames and patch of 11, at the clips' noise.
#[must_use]
pub fn nonlocal_pose_means(joints: usize) -> NonlocalPoseMeans {
    NonlocalPoseMeans {
        search_radius: Some(10),
        patch_radius: 5,
        bandwidth: vec![NOISE; joints],
        distance: Distance::Mean,
        weights: Weights::Pose,
        neighbors: None,
        chart: Chart::Mean,
        boundary: Boundary::Nearest,
        lookahead: None,
    }
}
