//! Features that frames are compared by: planes of coordinates per joint.

use crate::clip::Planes;

/// Distance between two samples of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// 3 planes of a vector: the length of the difference.
    Vector,
    /// 4 planes of a unit quaternion: the rotation angle. With these signs, no two samples are more than 180° apart.
    Narrow,
    /// 4 planes of a unit quaternion of either sign: the rotation angle.
    Wide,
}

/// Planes and distance of a joint.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Joint {
    /// Index of its first plane.
    pub(crate) row: usize,
    /// Its distance.
    pub(crate) kind: Kind,
}

/// Frames as planes, one column per frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Features<'a, T> {
    /// The coordinates that are compared.
    pub(crate) planes: &'a Planes<T>,
    /// Planes and distance of each joint.
    pub(crate) joints: &'a [Joint],
    /// Weight of each sample, a plane per joint; `None`: no sample is missing.
    pub(crate) shares: Option<&'a Planes<T>>,
}

/// Consecutive frames whose patches are compared: the centres of the patches.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Side<'a, T> {
    /// The frames and their surroundings.
    pub(crate) features: Features<'a, T>,
    /// The column of the first centre.
    pub(crate) at: usize,
    /// The frame index of the first centre, as callers count frames.
    pub(crate) first: usize,
    /// The number of centres.
    pub(crate) count: usize,
}
