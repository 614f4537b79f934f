//! Smoothing along the principal axes of the whole body: joints that move together steady each other.

use super::about::{About, Noisy};
use super::axes;
use super::joint;
use super::strength::Candidates;
use crate::clip::Planes;
use crate::error::check_length;
use crate::filters::columns::BLOCK;
use crate::parallel::{self, Interrupt};
use crate::rotations::quaternion;
use crate::simd::multiversion;
use crate::{ClipMut, Error, Real};
use std::sync::Mutex;

/// Share of the body's estimate beside the pilot.
const SHARE: f64 = 0.5;

/// Frames per task where poses are turned: the poses of a body stay in the second-level cache.
const TASK: usize = 8 * BLOCK;

/// Smooths all joints together along the principal axes of the body, and takes the mean with the pilot.
///
/// # Errors
/// [`Error::Length`] if slices do not fit together; [`Error::Interrupted`].
pub fn smooth_body<T: Real>(
    noisy: &Noisy<'_, T>,
    out: ClipMut<'_, T>,
    interrupt: &Interrupt,
) -> Result<(), Error> {
    noisy.check()?;
    let frames = noisy.clip.frames();
    let out = out.into_data();
    check_length("out", noisy.clip.data().len(), out.len())?;
    if frames < 2 || noisy.noise.iter().all(|&noise| noise <= 0.0) {
        return quaternion::normalize(noisy.pilot.data(), out);
    }
    let About { joints, mean, beside } = noisy.vectors(interrupt)?;
    let width = joints.len() * 3;
    let axes = body_axes(&mean, frames, interrupt)?;
    // Rows of the matrix are the axes from here on.
    let transposed: Vec<f64> = (0..width * width).map(|at| axes[at % width * width + at / width]).collect();
    let mut poses = turned(&transposed, width, frames, interrupt, |plane, range, block| {
        let (joint, c) = (plane / 3, plane % 3);
        let (mean, beside) = (&mean[joint].row(c)[range.clone()], &beside[joint].row(c)[range]);
        for ((out, mean), beside) in block.iter_mut().zip(mean).zip(beside) {
            *out = mean + beside;
        }
    })?;
    let candidates = Candidates::new(frames);
    let kept: Mutex<Vec<Planes<f64>>> = Mutex::default();
    let columns: Vec<&mut Vec<f64>> = poses.iter_mut().collect();
    parallel::for_each(columns, frames * width * 150, |_, column| {
        let mut spare = kept.lock().map_or(None, |mut kept| kept.pop()).unwrap_or_default();
        joint::smooth_column(column, &candidates, &mut spare, interrupt)?;
        if let Ok(mut kept) = kept.lock() {
            kept.push(spare);
        }
        Ok(())
    })?;
    let moved = turned(&axes, width, frames, interrupt, |plane, range, block| {
        block[..range.len()].copy_from_slice(&poses[plane][range]);
    })?;
    let by: Vec<Planes<f64>> = mean
        .into_iter()
        .enumerate()
        .map(|(joint, mut mean)| {
            for (c, plane) in mean.rows_mut::<3>(0).into_iter().enumerate() {
                for (mean, moved) in plane.iter_mut().zip(&moved[joint * 3 + c]) {
                    *mean = SHARE * (moved - *mean);
                }
            }
            mean
        })
        .collect();
    noisy.moved(&joints, &by, out)
}

/// Principal axes of the steps of all planes from frame to frame, as columns of a matrix.
fn body_axes(mean: &[Planes<f64>], frames: usize, interrupt: &Interrupt) -> Result<Vec<f64>, Error> {
    let width = mean.len() * 3;
    let tasks: Vec<usize> = (0..frames - 1).step_by(TASK).collect();
    let parts = parallel::map(tasks, frames * width * width / 8, |_, start| {
        interrupt.check()?;
        let length = TASK.min(frames - 1 - start);
        let mut steps = Planes::new(width, length);
        for plane in 0..width {
            let values = &mean[plane / 3].row(plane % 3)[start..=start + length];
            for (step, pair) in steps.row_mut(plane).iter_mut().zip(values.windows(2)) {
                *step = pair[1] - pair[0];
            }
        }
        let mut products = vec![0.0; width * width];
        for i in 0..width {
            for j in 0..=i {
                products[i * width + j] = inner_product(steps.row(i), steps.row(j));
            }
        }
        Ok(products)
    })?;
    let mut products = vec![0.0; width * width];
    for part in parts {
        for (sum, product) in products.iter_mut().zip(part) {
            *sum += product;
        }
    }
    for i in 0..width {
        for j in 0..i {
            products[j * width + i] = products[i * width + j];
        }
    }
    Ok(axes::eigenvectors(&mut products, width))
}

/// Products of a matrix with poses, whose planes `load` writes for a range of frames; one column for each row of the matrix.
fn turned(
    matrix: &[f64],
    width: usize,
    frames: usize,
    interrupt: &Interrupt,
    load: impl Fn(usize, std::ops::Range<usize>, &mut [f64]) + Sync,
) -> Result<Vec<Vec<f64>>, Error> {
    let mut columns = vec![vec![0.0; frames]; width];
    let mut tasks: Vec<Vec<&mut [f64]>> = Vec::new();
    for column in &mut columns {
        for (task, part) in column.chunks_mut(TASK).enumerate() {
            if tasks.len() <= task {
                tasks.push(Vec::with_capacity(width));
            }
            tasks[task].push(part);
        }
    }
    parallel::for_each(tasks, frames * width * width / 4, |task, mut parts| {
        interrupt.check()?;
        let start = task * TASK;
        let range = start..(start + TASK).min(frames);
        let mut poses = Planes::new(width, range.len());
        for plane in 0..width {
            load(plane, range.clone(), poses.row_mut(plane));
        }
        for (part, row) in parts.iter_mut().zip(matrix.chunks_exact(width)) {
            for (plane, &factor) in row.iter().enumerate() {
                joint::add_scaled(poses.row(plane), factor, part);
            }
        }
        Ok(())
    })?;
    Ok(columns)
}

multiversion! {
    /// Inner product, the same at every level: partial sums side by side.
    fn inner_product<T: Real>(a: &[T], b: &[T]) -> T {
        /// Partial sums: two vectors of float64 at the widest level.
        const LANES: usize = 16;
        let (a, a_rest) = a.as_chunks::<LANES>();
        let (b, b_rest) = b.as_chunks::<LANES>();
        let mut sums = [T::ZERO; LANES];
        for (a, b) in a.iter().zip(b) {
            for i in 0..LANES {
                sums[i] += a[i] * b[i];
            }
        }
        let mut sum = T::ZERO;
        for x in sums {
            sum += x;
        }
        for (a, b) in a_rest.iter().zip(b_rest) {
            sum += *a * *b;
        }
        sum
    }
}
