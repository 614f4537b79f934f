//! A joint in the coordinates of a frame: the number of coordinates needed, and their precision.

use super::chart::{self, Coordinates, Frame};

/// Coordinates of a rotation.
pub(super) const COMPONENTS: usize = 3;

/// Fraction of the tolerance that omitted coordinates may use.
const SHARE: f64 = 0.7;

/// Factor applied to a step: values are computed in 1/64 of it, and their rounding must fit too.
const MARGIN: f64 = 0.97;

/// Coordinates of the valid samples in a frame, as it can be stored.
pub(super) struct Fit {
    pub(super) width: u32,
    pub(super) numbers: [[i64; 3]; 2],
    pub(super) frame: Frame,
    pub(super) s: Coordinates,
    left: [f64; 4],
    pub(super) farthest: f64,
    skew: f64,
}

impl Fit {
    pub(super) fn new(valid: &[[f64; 4]], frame: [[f64; 4]; 2], width: u32) -> Self {
        let numbers = frame.map(|q| chart::rounded(q, width));
        let [centre, axes] = numbers.map(|numbers| chart::from_rounded(numbers, width));
        let frame = Frame { centre, axes };
        let s = chart::coordinates(valid, frame);
        let (left, farthest, skew) = chart::left(&s);
        Self { width, numbers, frame, s, left, farthest, skew }
    }

    /// Number of coordinates needed.
    pub(super) fn components(&self, bound: f64) -> usize {
        self.left.iter().take_while(|&&left| left > SHARE * bound).count()
    }

    /// A step whose errors stay within the bound.
    pub(super) fn step(&self, components: usize, bound: f64) -> f64 {
        let most = SHARE * bound;
        let left = if self.left[components] < most { self.left[components] } else { most };
        let axes = components as f64 + if components == COMPONENTS { 2.0 * self.skew } else { 0.0 };
        MARGIN * (bound * bound - left * left).sqrt() / axes.sqrt()
    }
}
