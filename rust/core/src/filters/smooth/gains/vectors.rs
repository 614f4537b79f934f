//! The columns of one joint, and the principal axes along which they lie.

use super::super::about::{CHUNK, Noisy, logarithms};
use super::super::body::inner_product;
use super::super::rank::eigen;
use super::basis::SOURCES;
use super::scales::Phases;
use super::{AXES, CELL, WIDEST};
use crate::clip::Planes;
use crate::eigen::eigenvectors;
use crate::parallel::{self, Interrupt};
use crate::simd::multiversion;
use crate::{ClipView, Error, Real};
use std::ops::Range;

/// Frames per task where steps are multiplied.
const TASK: usize = 2048;

/// Tasks whose products are held together.
const PASS: usize = 16;

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
        let reach = if width > WIDEST { 3 } else { width };
        let products = products(noisy, joints, reach, interrupt)?;
        let mut found = Vec::with_capacity(joints.len());
        for joint in 0..joints.len() {
            let row = |i: usize| (3 * joint + i) * reach + if width > WIDEST { 0 } else { 3 * joint };
            let mut block: Vec<f64> = (0..3).flat_map(|i| &products[row(i)..row(i) + 3]).copied().collect();
            let axes = eigenvectors(&mut block, 3, interrupt)?;
            found
                .push(std::array::from_fn(|i| std::array::from_fn(|axis| f32::from_f64(axes[i * 3 + axis]))));
        }
        let body = if width > WIDEST { Vec::new() } else { strongest(products, &found, interrupt)? };
        Ok(Self { joints: found, body })
    }

    /// How many axes of the body there are.
    pub(super) fn of_body(&self) -> usize {
        self.body.first().map_or(0, |joint| joint[0].len())
    }
}

/// Sums over frames of the products of steps; of each column with the `reach` columns of all joints, or of its own joint.
fn products<T: Real>(
    noisy: &Noisy<'_, T>,
    joints: &[usize],
    reach: usize,
    interrupt: &Interrupt,
) -> Result<Vec<f64>, Error> {
    let frames = noisy.clip.frames();
    let width = 3 * joints.len();
    let mut total = vec![0.0; width * reach];
    let starts: Vec<usize> = (1..frames).step_by(TASK).collect();
    for pass in starts.chunks(PASS) {
        let work = pass.len() * TASK * width * (100 + reach);
        let parts = parallel::map(pass.to_vec(), work, |_, start| {
            interrupt.check()?;
            let length = TASK.min(frames - start);
            let mut steps = Planes::<f64>::new(width, length);
            for (i, &joint) in joints.iter().enumerate() {
                let scale = 2.0 / noisy.noise[joint];
                let before = noisy.pilot.slice(start - 1, start - 1 + length);
                let after = noisy.pilot.slice(start, start + length);
                displacements(before, after, joint, |t, step| {
                    for (c, x) in step.into_iter().enumerate() {
                        steps.row_mut(3 * i + c)[t] = x.to_f64() * scale;
                    }
                });
            }
            let mut part = vec![0.0; width * reach];
            for i in 0..width {
                let first = if reach == width { 0 } else { i - i % 3 };
                for j in first..=i {
                    let product = inner_product(steps.row(i), steps.row(j));
                    part[i * reach + j - first] = product;
                    part[j * reach + i - first] = product;
                }
            }
            Ok(part)
        })?;
        for part in parts {
            for (sum, product) in total.iter_mut().zip(part) {
                *sum += product;
            }
        }
    }
    Ok(total)
}

/// Components of the axes of the joints along the eigenvectors with the largest eigenvalues.
fn strongest(
    mut products: Vec<f64>,
    joints: &[[[f32; 3]; 3]],
    interrupt: &Interrupt,
) -> Result<Vec<[Vec<f32>; 3]>, Error> {
    let width = 3 * joints.len();
    let (values, vectors) = eigen(&mut products, width, interrupt)?;
    let mut order: Vec<usize> = (0..width).collect();
    order.sort_by(|&a, &b| values[b].total_cmp(&values[a]));
    order.truncate(AXES.min(joints.len()));
    let component = |joint: usize, axes: &[[f32; 3]; 3], axis: usize, vector: usize| {
        let vector = &vectors[vector * width + 3 * joint..][..3];
        f32::from_f64(vector.iter().zip(axes).map(|(x, row)| x * f64::from(row[axis])).sum())
    };
    let of_joint = |(joint, axes)| {
        std::array::from_fn(|axis| order.iter().map(|&vector| component(joint, axes, axis, vector)).collect())
    };
    Ok(joints.iter().enumerate().map(of_joint).collect())
}

/// Half rotation vectors of a joint, from one clip to another, the shorter way.
fn displacements<T: Real>(
    from: ClipView<'_, T>,
    to: ClipView<'_, T>,
    joint: usize,
    mut take: impl FnMut(usize, [T; 3]),
) {
    for start in (0..from.frames()).step_by(CHUNK) {
        let length = CHUNK.min(from.frames() - start);
        let mut samples = [[[T::ZERO; CHUNK]; 4]; 2];
        for i in 0..length {
            for (samples, clip) in samples.iter_mut().zip([from, to]) {
                for (plane, x) in samples.iter_mut().zip(clip.at(start + i, joint)) {
                    plane[i] = x;
                }
            }
        }
        let mut found = [[T::ZERO; CHUNK]; 3];
        logarithms(&samples[0], &samples[1], &mut found);
        let [x, y, z] = found;
        for (i, ((x, y), z)) in x.into_iter().zip(y).zip(z).enumerate().take(length) {
            take(start + i, [x, y, z]);
        }
    }
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
    let pilot = noisy.pilot.slice(range.start, range.end);
    let scale = 2.0 / noisy.noise[joint];
    let mut vectors = Planes::<f32>::new(3, frames);
    let mut turned = vec![0.0; frames];
    let others = [noisy.clip, noisy.pilot, patches];
    for (source, other) in others.into_iter().enumerate() {
        let [x, y, z] = vectors.rows_mut::<3>(0);
        let mut write = |t: usize, v: [f64; 3]| {
            [x[t], y[t], z[t]] = v.map(f32::from_f64);
        };
        if source == 1 {
            // The development of the pilot; only its differences count.
            let mut sum = [0.0; 3];
            write(0, sum);
            displacements(pilot.slice(0, frames - 1), pilot.slice(1, frames), joint, |t, step| {
                for (sum, step) in sum.iter_mut().zip(step) {
                    *sum += step.to_f64() * scale;
                }
                write(t + 1, sum);
            });
        } else {
            displacements(pilot, other.slice(range.start, range.end), joint, |t, way| {
                let factor = match noisy.confidence {
                    Some(confidence) if source == 0 => {
                        scale * confidence[(range.start + t) * noisy.clip.joints() + joint].to_f64()
                    }
                    _ => scale,
                };
                write(t, way.map(|x| x.to_f64() * factor));
            });
        }
        for axis in 0..3 {
            combine(vectors.rows_from::<3>(0), axes.map(|row| row[axis]), &mut turned);
            result.load(3 * source + axis, &turned, source > 0);
        }
    }
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
