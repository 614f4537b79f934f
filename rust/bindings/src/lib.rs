//! The module `quatfilt._core`: converts arrays, detaches from the interpreter, calls the core. No arithmetic.
//!
//! Each function has the name and the positional arguments of its definition in `quatfilt._reference`; streams have none
//! there, for the filter of the whole clip defines them.

mod array;
mod filters;
mod formats;
mod geodesics;
mod motion;
mod noise;
mod reconstruction;
mod rotations;
mod sampling;
mod search;
mod threads;

#[pyo3::pymodule]
mod _core {
    #[pymodule_export]
    use super::filters::bilateral::bilateral;
    #[pymodule_export]
    use super::filters::butterworth::butterworth;
    #[pymodule_export]
    use super::filters::confidence::pulled_by_confidence;
    #[pymodule_export]
    use super::filters::despike::{find_spikes, find_swaps};
    #[pymodule_export]
    use super::filters::development::{develop, undevelop};
    #[pymodule_export]
    use super::filters::gaps::fill_gaps;
    #[pymodule_export]
    use super::filters::gaussian::gaussian;
    #[pymodule_export]
    use super::filters::kalman::{filter, kalman_process_noise, kalman_vectors, kalman_vectors_ratio};
    #[pymodule_export]
    use super::filters::nonlocal_pose_means::nonlocal_pose_means;
    #[pymodule_export]
    use super::filters::one_euro::one_euro;
    #[pymodule_export]
    use super::filters::orientation_filter::orientation_filter;
    #[pymodule_export]
    use super::filters::savgol::{savgol, savgol_derivative};
    #[pymodule_export]
    use super::filters::smooth::body::smooth_body;
    #[pymodule_export]
    use super::filters::smooth::gains::smooth_gains;
    #[pymodule_export]
    use super::filters::smooth::low_pass::low_pass;
    #[pymodule_export]
    use super::filters::smooth::patches::smooth_patches;
    #[pymodule_export]
    use super::filters::smooth::rank::smooth_rank;
    #[pymodule_export]
    use super::filters::smooth::smooth;
    #[pymodule_export]
    use super::filters::stream::PoseStream;
    #[pymodule_export]
    use super::filters::stream::bilateral::bilateral_stream;
    #[pymodule_export]
    use super::filters::stream::kalman::kalman_stream;
    #[pymodule_export]
    use super::filters::stream::nonlocal_pose_means::nonlocal_pose_means_stream;
    #[pymodule_export]
    use super::filters::stream::one_euro::one_euro_stream;
    #[pymodule_export]
    use super::filters::weighted_moving_mean::weighted_moving_mean;
    #[pymodule_export]
    use super::formats::FormatError;
    #[pymodule_export]
    use super::formats::acclaim::{read_amc, read_asf};
    #[pymodule_export]
    use super::formats::bvh::{read_bvh, write_bvh};
    #[pymodule_export]
    use super::geodesics::body::{body_geodesics, body_product, body_scores};
    #[pymodule_export]
    use super::geodesics::compress::{compress, decompress, principal_frames};
    #[pymodule_export]
    use super::geodesics::pga::{geodesic_centre, geodesic_product, geodesic_scores, principal_geodesics};
    #[pymodule_export]
    use super::geodesics::segment::segment;
    #[pymodule_export]
    use super::motion::feet::{foot_displacements, place_feet};
    #[pymodule_export]
    use super::motion::skeleton::{forward_kinematics, forward_kinematics_moving};
    #[pymodule_export]
    use super::noise::model::{noise_along_time, noise_axes, noise_colour, noise_over_motion};
    #[pymodule_export]
    use super::noise::noise::noise_level;
    #[pymodule_export]
    use super::noise::repeats::find_repeats;
    #[pymodule_export]
    use super::noise::whiten::{drawn_towards, unwhiten, whiten};
    #[pymodule_export]
    use super::reconstruction::features::pose_features;
    #[pymodule_export]
    use super::reconstruction::heading::split_heading;
    #[pymodule_export]
    use super::reconstruction::local_models::predict_pose;
    #[pymodule_export]
    use super::reconstruction::solver::solve_pose;
    #[pymodule_export]
    use super::reconstruction::tracker::{MotionTracker, TrackerTables, track, track_stream};
    #[pymodule_export]
    use super::rotations::continuity::continuous;
    #[pymodule_export]
    use super::rotations::euler::{continuous_euler, from_euler, to_euler};
    #[pymodule_export]
    use super::rotations::mean::mean;
    #[pymodule_export]
    use super::rotations::quaternion::{conjugate, exp, geodesic_distance, log, multiply, normalize, scan};
    #[pymodule_export]
    use super::rotations::resample::slerp;
    #[pymodule_export]
    use super::sampling::sampling::sampling;
    #[pymodule_export]
    use super::sampling::spline::{knots, spline};
    #[pymodule_export]
    use super::sampling::tracker_noise::tracker_noise;
    #[pymodule_export]
    use super::search::patch_neighbors::patch_neighbors;
    #[pymodule_export]
    use super::search::poses::{SegmentWalk, nearest_segments, neighbor_graph, segment_walk};
    #[pymodule_export]
    use super::threads::{get_num_threads, is_debug_build, set_num_threads, simd_level};
}
