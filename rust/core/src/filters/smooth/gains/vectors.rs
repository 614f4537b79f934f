//! The columns of one joint, and the principal axes along which they lie.

use super::super::about::{About, Noisy};
use super::super::products::padded;
use super::super::steps;
use super::super::symmetric::leading;
use super::basis::SOURCES;
use super::scales::Phases;
use super::{AXES, CELL, WIDEST};
use crate::clip::Planes;
use crate::eigen::eigenvectors;
use crate::parallel::Interrupt;
use crate::simd::multiversion;
use crate::{ClipView, Error, Real};
use std::ops::Range;

/// Principal axes of the steps of the pilot.
#[derive(Debug)]
pub(super) struct Axes {
    /// Of each noisy joint, as columns.
    pub(super) joints: Vec<[[f32; 3]; 3]>,
    /// Of each axis of each joint, its components along the strongest axes of the body; none if there are too many joints.
    pub(super) body: Vec<[Vec<f32>; 3]>,
}

impl Axes {
    /// Finds the axes of joints, whose steps are divided by their noise.
    pub(super) fn find<T: Real>(
        noisy: &Noisy<'_, T>,
        joints: &[usize],
        interrupt: &Interrupt,
    ) -> Result<Self, Error> {
        let width = 3 * joints.len();
        // The axes of a joint need the products of its own steps only.
        let together = if width > WIDEST { 1 } else { joints.len() };
        let mut found = Vec::with_capacity(joints.len());
        let mut body = Vec::new();
        for joints in joints.chunks(together) {
            let products = steps::of_all(noisy, joints, interrupt)?;
            for joint in 0..joints.len() {
                let mut block = square(&products, joints.len(), 3 * joint..3 * joint + 3);
                let axes = eigenvectors(&mut block, 3, interrupt)?;
                let component = |i: usize, axis: usize| f32::from_f64(axes[i * 3 + axis]);
                found.push(std::array::from_fn(|i| std::array::from_fn(|axis| component(i, axis))));
            }
            if width <= WIDEST {
                body = strongest(square(&products, joints.len(), 0..width), &found, interrupt)?;
            }
        }
        Ok(Self { joints: found, body })
    }

    /// How many axes of the body there are.
    pub(super) fn of_body(&self) -> usize {
        self.body.first().map_or(0, |joint| joint[0].len())
    }
}

/// Some rows of the products of steps, and the same columns; of the products those right of the diagonal are read.
fn square(products: &[f64], joints: usize, rows: Range<usize>) -> Vec<f64> {
    let stride = padded(3 * joints);
    let row = |i: usize| rows.clone().map(move |j| products[i.min(j) * stride + i.max(j)]);
    rows.clone().flat_map(row).collect()
}

/// Components of the axes of the joints along the eigenvectors with the largest eigenvalues.
fn strongest(
    mut products: Vec<f64>,
    joints: &[[[f32; 3]; 3]],
    interrupt: &Interrupt,
) -> Result<Vec<[Vec<f32>; 3]>, Error> {
    let width = 3 * joints.len();
    let (_, vectors) = leading(&mut products, width, 0.0, interrupt)?;
    let component = |joint: usize, axes: &[[f32; 3]; 3], axis: usize, vector: &[f64]| {
        let vector = &vector[3 * joint..][..3];
        f32::from_f64(vector.iter().zip(axes).map(|(x, row)| x * f64::from(row[axis])).sum())
    };
    let of_joint = |(joint, axes)| {
        std::array::from_fn(|axis| {
            let strongest = vectors.chunks_exact(width).take(AXES.min(joints.len()));
            strongest.map(|vector| component(joint, axes, axis, vector)).collect()
        })
    };
    Ok(joints.iter().enumerate().map(of_joint).collect())
}

/// The columns of a joint along its axes, in units of its noise: all sources but the projection on the axes of the body, which is 0.
pub(super) fn sources<T: Real>(
    noisy: &Noisy<'_, T>,
    patches: ClipView<'_, T>,
    joint: usize,
    range: &Range<usize>,
    axes: &[[f32; 3]; 3],
) -> Phases {
    let frames = range.len();
    let mut result = Phases::default();
    result.reshape(3 * SOURCES, frames.div_ceil(CELL));
    let mut vectors = Planes::<f32>::new(3, frames);
    let mut turned = vec![0.0; frames];
    let mut take = |source: usize, planes: [&[f64]; 3]| {
        for (c, plane) in planes.into_iter().enumerate() {
            for (to, x) in vectors.row_mut(c).iter_mut().zip(plane) {
                *to = f32::from_f64(*x);
            }
        }
        for axis in 0..3 {
            combine(vectors.rows_from::<3>(0), axes.map(|row| row[axis]), &mut turned);
            result.load(3 * source + axis, &turned, source > 0);
        }
    };
    let mut about = About::default();
    noisy.joint_vectors(joint, range.clone(), &mut about);
    take(0, about.beside());
    take(1, about.mean());
    let to_patches = Noisy { clip: patches, confidence: None, ..*noisy };
    to_patches.joint_vectors(joint, range.clone(), &mut about);
    take(2, about.beside());
    for axis in 0..3 {
        result.load(3 * (SOURCES - 1) + axis, &[], false);
    }
    result
}

multiversion! {
    /// Sum of three planes, each times a factor.
    pub(super) fn combine(planes: [&[f32]; 3], by: [f32; 3], out: &mut [f32]) {
        let n = out.len();
        let [x, y, z] = planes;
        let (x, y, z) = (&x[..n], &y[..n], &z[..n]);
        for i in 0..n {
            out[i] = by[0] * x[i] + by[1] * y[i] + by[2] * z[i];
        }
    }
}
