//! Smoothing along the principal axes of the whole body: joints that move together steady each other.
//!
//! Poses are turned to the axes part by part of the clip, each with a development of its own; along an axis the parts are put
//! together, smoothed, and kept in the precision of the clip. The way back goes part by part again.

use super::LEAST_NOISE;
use super::about::{About, Noisy};
use super::joint;
use super::penalised::LANES;
use super::products::{padded, product};
use super::steps;
use super::strength::Candidates;
use super::symmetric::leading;
use crate::clip::Planes;
use crate::error::check_length;
use crate::filters::columns::BLOCK;
use crate::parallel::{self, Interrupt};
use crate::{ClipMut, Error, Real};
use std::sync::Mutex;

/// Share of the body's estimate beside the pilot.
const SHARE: f64 = 0.5;

/// Frames per axis, at least: the axes of shorter clips are those of the noise that the pilot has left.
const FEWEST: usize = 3;

/// Sum of squares of the pilot's steps along an axis, in units of the noise, below which the axis is left to the pilot.
const STILL: f64 = 0.03;

/// Joints of a body, at most: more are as many bodies as there must be, of nearly one size.
const JOINTS: usize = 64;

/// Frames of a part. Poses of a body stay in the second-level cache, and rows of planes do not fall on the same lines of the first.
const PART: usize = 480;

/// Joints that are smoothed together, and the axes along which they move.
struct Body {
    joints: Vec<usize>,
    /// One axis after the other, three numbers for each joint.
    axes: Vec<f64>,
    /// The same numbers joint by joint, times the share of the result.
    back: Vec<f64>,
}

impl Body {
    /// How many numbers a pose has.
    fn width(&self) -> usize {
        3 * self.joints.len()
    }

    /// How many axes there are.
    fn moving(&self) -> usize {
        self.axes.len() / self.width()
    }
}

/// A part of the poses of a body, seen along its axes.
struct Part<T> {
    /// Of each axis, the numbers of [`PART`] frames, from the pilot's first one on.
    along: Vec<T>,
    /// How far the pilot goes from the first frame of this part to that of the next one, along each axis.
    ahead: Vec<f64>,
}

/// Memory that goes from task to task.
#[derive(Default)]
struct Buffers {
    about: Vec<About>,
    poses: Vec<f64>,
    turned: Vec<f64>,
    moves: Vec<f64>,
}

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
    let joints = noisy.joints(LEAST_NOISE);
    let size = joints.len().div_ceil(joints.len().div_ceil(JOINTS).max(1)).max(1);
    let mut bodies = Vec::new();
    for joints in joints.chunks(size).filter(|joints| frames >= FEWEST * 3 * joints.len()) {
        let body = moving_axes(noisy, joints, interrupt)?;
        if body.moving() > 0 {
            bodies.push(body);
        }
    }
    if bodies.is_empty() {
        return noisy.unmoved(out);
    }
    let candidates = Candidates::new(frames);
    let kept: Mutex<Vec<Buffers>> = Mutex::default();
    let mut smoothed = Vec::with_capacity(bodies.len());
    for body in &bodies {
        let mut parts = parts(noisy, body, &kept, interrupt)?;
        smooth_along(&mut parts, body.moving(), frames, &candidates, interrupt)?;
        smoothed.push(parts);
    }
    let moving: Vec<usize> = bodies.iter().flat_map(|body| body.joints.iter().copied()).collect();
    let work = moving.len() * JOINTS;
    noisy.each_part(PART, out, work, |first, out| {
        interrupt.check()?;
        let mut buffers = kept.lock().map_or(None, |mut kept| kept.pop()).unwrap_or_default();
        let mut moves = std::mem::take(&mut buffers.moves);
        moves.resize(3 * moving.len() * PART, 0.0);
        let mut rest = &mut moves[..];
        for (body, parts) in bodies.iter().zip(&smoothed) {
            let (here, after) = rest.split_at_mut(body.width() * PART);
            back(noisy, body, first, &parts[first / PART], &mut buffers, here);
            rest = after;
        }
        noisy.moved(&moving, first, |joint, c| &moves[(joint * 3 + c) * PART..][..PART], out);
        buffers.moves = moves;
        if let Ok(mut kept) = kept.lock() {
            kept.push(buffers);
        }
        Ok(())
    })?;
    noisy.sign(out)
}

/// Principal axes of the steps of all planes from frame to frame, but for the still ones.
fn moving_axes<T: Real>(
    noisy: &Noisy<'_, T>,
    joints: &[usize],
    interrupt: &Interrupt,
) -> Result<Body, Error> {
    let width = 3 * joints.len();
    let products = steps::of_all(noisy, joints, interrupt)?;
    let mut matrix: Vec<f64> = (0..width * width)
        .map(|at| {
            let (i, j) = (at / width, at % width);
            products[i.min(j) * padded(width) + i.max(j)]
        })
        .collect();
    let (_, axes) = leading(&mut matrix, width, STILL, interrupt)?;
    let moving = axes.len() / width;
    let back = (0..width * moving).map(|at| SHARE * axes[at % moving * width + at / moving]).collect();
    Ok(Body { joints: joints.to_vec(), axes, back })
}

/// Writes planes of the poses of a body, of [`PART`] frames each: the pilot's and `beside` times the way to the samples.
fn load(about: &[About], beside: f64, poses: &mut Vec<f64>) {
    poses.resize(3 * about.len() * PART, 0.0);
    let planes = about.iter().flat_map(|about| about.mean().into_iter().zip(about.beside()));
    for (pose, (mean, way)) in poses.chunks_exact_mut(PART).zip(planes) {
        let length = mean.len().min(PART);
        pose[length..].fill(0.0);
        for (x, (mean, way)) in pose.iter_mut().zip(mean.iter().zip(way)) {
            *x = mean + beside * way;
        }
    }
}

/// The samples of a body along its axes.
fn parts<T: Real>(
    noisy: &Noisy<'_, T>,
    body: &Body,
    kept: &Mutex<Vec<Buffers>>,
    interrupt: &Interrupt,
) -> Result<Vec<Part<T>>, Error> {
    let frames = noisy.clip.frames();
    let (width, moving) = (body.width(), body.moving());
    let starts: Vec<usize> = (0..frames).step_by(PART).collect();
    parallel::map(starts, frames * width * (30 + moving / 4), |_, first| {
        interrupt.check()?;
        let mut buffers = kept.lock().map_or(None, |mut kept| kept.pop()).unwrap_or_default();
        let Buffers { about, poses, turned, .. } = &mut buffers;
        about.resize_with(body.joints.len(), About::default);
        // One frame more: there the next part begins.
        let end = frames.min(first + PART + 1);
        for (about, &joint) in about.iter_mut().zip(&body.joints) {
            noisy.joint_vectors(joint, first..end, about);
        }
        load(about, 1.0, poses);
        turned.resize(moving * PART, 0.0);
        product(&body.axes, width, poses, PART, turned);
        let ahead = |axis: &[f64]| {
            let planes = about.iter().flat_map(About::mean);
            planes.zip(axis).map(|(plane, x)| plane[end - first - 1] * x).sum::<f64>()
        };
        let ahead = body.axes.chunks_exact(width).map(ahead).collect();
        let along = turned.iter().map(|&x| T::from_f64(x)).collect();
        if let Ok(mut kept) = kept.lock() {
            kept.push(buffers);
        }
        Ok(Part { along, ahead })
    })
}

/// Smooths along each axis.
fn smooth_along<T: Real>(
    parts: &mut [Part<T>],
    moving: usize,
    frames: usize,
    candidates: &Candidates,
    interrupt: &Interrupt,
) -> Result<(), Error> {
    let mut tasks: Vec<Vec<(&mut [T], f64)>> = (0..moving).map(|_| Vec::new()).collect();
    let mut total = vec![0.0; moving];
    for Part { along, ahead } in parts {
        for (axis, numbers) in along.chunks_exact_mut(PART).enumerate() {
            tasks[axis].push((numbers, total[axis]));
            total[axis] += ahead[axis];
        }
    }
    let kept: Mutex<Vec<(Vec<f64>, Planes<f64>)>> = Mutex::default();
    let work = frames * moving * 100;
    parallel::for_each(tasks.chunks_mut(LANES).collect(), work, |_, axes: &mut [Vec<(&mut [T], f64)>]| {
        let (mut columns, mut memory) = kept.lock().map_or(None, |mut kept| kept.pop()).unwrap_or_default();
        let padded = frames.next_multiple_of(BLOCK);
        columns.resize(LANES * padded, 0.0);
        for (column, parts) in columns.chunks_exact_mut(padded).zip(&*axes) {
            for (column, (numbers, from)) in column[..frames].chunks_mut(PART).zip(parts) {
                for (x, number) in column.iter_mut().zip(&**numbers) {
                    *x = number.to_f64() + from;
                }
            }
        }
        joint::smooth_some(&mut columns, (axes.len(), frames), candidates, &mut memory, interrupt)?;
        for (column, parts) in columns.chunks_exact(padded).zip(axes) {
            for (column, (numbers, from)) in column[..frames].chunks(PART).zip(parts) {
                for (to, x) in numbers.iter_mut().zip(column) {
                    *to = T::from_f64(x - *from);
                }
            }
        }
        if let Ok(mut kept) = kept.lock() {
            kept.push((columns, memory));
        }
        Ok(())
    })
}

/// The share of the way from the pilot to what is smooth along the axes, for a part that begins at the frame `first`.
fn back<T: Real>(
    noisy: &Noisy<'_, T>,
    body: &Body,
    first: usize,
    part: &Part<T>,
    buffers: &mut Buffers,
    moves: &mut [f64],
) {
    let Buffers { about, poses, turned, .. } = buffers;
    let end = noisy.clip.frames().min(first + PART);
    about.resize_with(body.joints.len(), About::default);
    for (about, &joint) in about.iter_mut().zip(&body.joints) {
        noisy.joint_vectors(joint, first..end, about);
    }
    load(about, 0.0, poses);
    turned.resize(body.moving() * PART, 0.0);
    product(&body.axes, body.width(), poses, PART, turned);
    for (x, smooth) in turned.iter_mut().zip(&part.along) {
        *x = smooth.to_f64() - *x;
    }
    product(&body.back, body.moving(), turned, PART, moves);
}
