//! Coordinates of a frame whose squared differences sum to at most the squared rotation angles.

use super::kernels;
use crate::Real;
use crate::search::diagonal::Measure;
use crate::search::features::{Features, Kind};
use std::ops::Range;

/// Index pairs of a quaternion's components: their products do not depend on the quaternion's sign.
const PAIRS: [[usize; 2]; 10] =
    [[0, 0], [1, 1], [2, 2], [3, 3], [0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];

/// Coordinates (axes) of one joint's chord.
pub(super) const GROUP: usize = 4;

/// One coordinate: `factor · x − offset` or `factor · x · y − offset`, with components `x` and `y` of a joint.
#[derive(Debug, Clone, Copy)]
pub(super) struct Axis<T> {
    joint: usize,
    component: usize,
    other: Option<usize>,
    factor: T,
    offset: T,
}

impl<T: Real> Axis<T> {
    fn new(joint: usize, component: usize, other: Option<usize>, square: T) -> Self {
        Self { joint, component, other, factor: square.sqrt(), offset: T::ZERO }
    }

    /// Writes this coordinate for consecutive columns, from the column `from` on.
    fn write(&self, features: &Features<'_, T>, from: usize, out: &mut [T]) {
        let row = features.joints[self.joint].row;
        let plane = |component: usize| &features.planes.row(row + component)[from..from + out.len()];
        let x = plane(self.component);
        match self.other {
            Some(other) => kernels::scaled_products(out, x, plane(other), self.factor, self.offset),
            None => kernels::scaled(out, x, self.factor, self.offset),
        }
    }
}

/// The coordinates that are computed for every frame.
#[derive(Debug, Clone)]
pub(super) struct Axes<T> {
    pub(super) axes: Vec<Axis<T>>,
    /// Number of leading groups of [`GROUP`] whose products keep their sign. The remaining groups add the magnitude
    /// of theirs.
    pub(super) signed: usize,
}

impl<T: Real> Axes<T> {
    /// Chords, a group per joint: `θ² ≥ 4 |a ∓ b|²`.
    pub(super) fn chords(measure: &Measure<T>, kinds: &[Kind]) -> Self {
        let (mut axes, mut signed) = (Vec::new(), 0);
        for wide in [false, true] {
            for joint in measure.joints.clone().filter(|&joint| (kinds[joint] == Kind::Wide) == wide) {
                let factor = measure.factors[joint];
                for component in 0..GROUP {
                    axes.push(match kinds[joint] {
                        Kind::Vector if component == 3 => Axis::new(joint, 0, None, T::ZERO),
                        Kind::Vector => Axis::new(joint, component, None, factor),
                        _ => Axis::new(joint, component, None, T::TWO * T::TWO * factor),
                    });
                }
                signed += usize::from(!wide);
            }
        }
        Self { axes, signed }
    }

    /// Points whose distances are at most the angles for either sign of a quaternion. Where signs are not known: `θ²
    /// ≥ 4 sin²(θ/2) = 2 |aaᵀ − bbᵀ|²`.
    pub(super) fn points(measure: &Measure<T>, kinds: &[Kind]) -> Self {
        let mut axes = Vec::new();
        for joint in measure.joints.clone() {
            let factor = measure.factors[joint];
            let double = T::TWO * factor;
            match kinds[joint] {
                Kind::Vector => axes.extend((0..3).map(|i| Axis::new(joint, i, None, factor))),
                Kind::Narrow => axes.extend((0..4).map(|i| Axis::new(joint, i, None, T::TWO * double))),
                Kind::Wide => axes.extend(PAIRS.map(|[i, j]| {
                    Axis::new(joint, i, Some(j), if i == j { double } else { T::TWO * double })
                })),
            }
        }
        Self { signed: axes.len().div_ceil(GROUP), axes }
    }

    /// The number of coordinates.
    pub(super) fn count(&self) -> usize {
        self.axes.len()
    }

    /// Sets the offsets of the signed coordinates to their means over `columns`: centred values are small, and so are
    /// their rounding errors.
    pub(super) fn centre(&mut self, features: &Features<'_, T>, columns: &[usize]) {
        let share = 1.0 / columns.len().max(1) as f64;
        for axis in self.axes.iter_mut().take(GROUP * self.signed) {
            let mut mean = 0.0;
            for &column in columns {
                let mut number = [T::ZERO];
                axis.write(features, column, &mut number);
                mean += share * number[0].to_f64();
            }
            axis.offset = T::from_f64(mean);
        }
    }

    /// Writes all coordinates of one column.
    pub(super) fn read(&self, features: &Features<'_, T>, column: usize, numbers: &mut [T]) {
        for (axis, number) in self.axes.iter().zip(numbers) {
            axis.write(features, column, std::slice::from_mut(number));
        }
    }

    /// Runs `work(first, planes)` for each group of coordinates over a range of columns.
    pub(super) fn each_group(
        &self,
        features: &Features<'_, T>,
        columns: Range<usize>,
        planes: &mut Vec<T>,
        mut work: impl FnMut(usize, [&[T]; GROUP]),
    ) {
        let length = columns.len();
        if length == 0 {
            return;
        }
        planes.resize(GROUP * length, T::ZERO);
        for (group, axes) in self.axes.chunks(GROUP).enumerate() {
            if axes.len() < GROUP {
                planes.fill(T::ZERO);
            }
            for (axis, plane) in axes.iter().zip(planes.chunks_exact_mut(length)) {
                axis.write(features, columns.start, plane);
            }
            let plane = |i: usize| &planes[i * length..(i + 1) * length];
            work(group * GROUP, [plane(0), plane(1), plane(2), plane(3)]);
        }
    }
}
