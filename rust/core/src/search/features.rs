//! What frames are compared by: planes of numbers per joint.

use crate::clip::Planes;

/// How two frames of a joint are compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// 3 planes of a vector: by the length of the difference.
    Vector,
    /// 4 planes of a unit quaternion, no two of which are more than half a turn apart as they are signed: by the angle.
    Narrow,
    /// 4 planes of a unit quaternion or its negative: by the angle.
    Wide,
}

/// Where a joint stands in the planes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Joint {
    /// Its first plane.
    pub(crate) row: usize,
    /// How it is compared.
    pub(crate) kind: Kind,
}

/// Frames as planes, one column per frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Features<'a, T> {
    /// The numbers that are compared.
    pub(crate) planes: &'a Planes<T>,
    /// Where each joint stands.
    pub(crate) joints: &'a [Joint],
    /// How far each sample counts, a plane per joint; `None`: all are complete.
    pub(crate) shares: Option<&'a Planes<T>>,
}

/// Frames in sequence whose patches are compared: the middles of the patches.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Side<'a, T> {
    /// The frames and their surroundings.
    pub(crate) features: Features<'a, T>,
    /// The column of the first middle.
    pub(crate) at: usize,
    /// The number of the first middle, by which it is known outside.
    pub(crate) first: usize,
    /// How many middles.
    pub(crate) count: usize,
}
