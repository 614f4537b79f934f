//! Smoothing along the principal axes of the whole body: joints that move together steady each other.

use super::LEAST_NOISE;
use super::about::{About, Noisy};
use super::joint;
use super::strength::Candidates;
use crate::clip::Planes;
use crate::eigen::eigenvectors;
use crate::error::check_length;
use crate::filters::columns::BLOCK;
use crate::parallel::{self, Interrupt};
use crate::simd::multiversion;
use crate::{ClipMut, Error, Real};
use std::sync::Mutex;

/// Share of the body's estimate beside the pilot.
const SHARE: f64 = 0.5;

/// Frames per axis, at least: the axes of shorter clips are those of the noise that the pilot has left.
const FEWEST: usize = 3;

/// Sum of squares of the pilot's steps along an axis, in units of the noise, below which the axis is left to the pilot.
const STILL: f64 = 0.03;

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
    if out.is_empty() {
        return Ok(());
    }
    let width = 3 * noisy.noise.iter().filter(|&&noise| noise >= LEAST_NOISE).count();
    if width == 0 || frames < FEWEST * width {
        return noisy.moved(&[], &[], out);
    }
    let About { joints, mut mean, beside } = noisy.vectors(interrupt)?;
    let axes = moving_axes(&mean, frames, interrupt)?;
    if axes.is_empty() {
        return noisy.moved(&[], &[], out);
    }
    let along = |planes: &[Planes<f64>]| {
        turned(&axes, width, frames, interrupt, |plane, range, block| {
            block[..range.len()].copy_from_slice(&planes[plane / 3].row(plane % 3)[range]);
        })
    };
    let pilot = along(&mean)?;
    let mut columns = along(&beside)?;
    let candidates = Candidates::new(frames);
    let kept: Mutex<Vec<Planes<f64>>> = Mutex::default();
    let tasks: Vec<_> = columns.iter_mut().zip(&pilot).collect();
    parallel::for_each(tasks, frames * pilot.len() * 150, |_, (column, pilot)| {
        let mut spare = kept.lock().map_or(None, |mut kept| kept.pop()).unwrap_or_default();
        joint::add_scaled(pilot, 1.0, column);
        joint::smooth_column(column, &candidates, &mut spare, interrupt)?;
        joint::add_scaled(pilot, -1.0, column);
        if let Ok(mut kept) = kept.lock() {
            kept.push(spare);
        }
        Ok(())
    })?;
    let moving = columns.len();
    // Back from the axes: what were columns of the matrix are its rows.
    let back: Vec<f64> =
        (0..width * moving).map(|at| SHARE * axes[at % moving * width + at / moving]).collect();
    let moved = turned(&back, moving, frames, interrupt, |plane, range, block| {
        block[..range.len()].copy_from_slice(&columns[plane][range]);
    })?;
    for (joint, by) in mean.iter_mut().enumerate() {
        for (c, plane) in by.rows_mut::<3>(0).into_iter().enumerate() {
            plane[..frames].copy_from_slice(&moved[joint * 3 + c]);
        }
    }
    noisy.moved(&joints, &mean, out)
}

/// Principal axes of the steps of all planes from frame to frame, but for the still ones: rows of a matrix.
fn moving_axes(mean: &[Planes<f64>], frames: usize, interrupt: &Interrupt) -> Result<Vec<f64>, Error> {
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
    let axes = eigenvectors(&mut products, width, interrupt)?;
    let moving = (0..width).filter(|&axis| products[axis * width + axis] > STILL);
    Ok(moving.flat_map(|axis| axes.iter().skip(axis).step_by(width)).copied().collect())
}

/// Products of a matrix of rows of `width` numbers with poses, whose planes `load` writes for a range of frames; one column for
/// each row of the matrix.
fn turned(
    matrix: &[f64],
    width: usize,
    frames: usize,
    interrupt: &Interrupt,
    load: impl Fn(usize, std::ops::Range<usize>, &mut [f64]) + Sync,
) -> Result<Vec<Vec<f64>>, Error> {
    let rows = matrix.len() / width;
    let mut columns = vec![vec![0.0; frames]; rows];
    let mut tasks: Vec<Vec<&mut [f64]>> = Vec::new();
    for column in &mut columns {
        for (task, part) in column.chunks_mut(TASK).enumerate() {
            if tasks.len() <= task {
                tasks.push(Vec::with_capacity(rows));
            }
            tasks[task].push(part);
        }
    }
    parallel::for_each(tasks, frames * width * rows / 4, |task, mut parts| {
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
    pub(super) fn inner_product<T: Real>(a: &[T], b: &[T]) -> T {
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
