//! One block of frames.

use super::super::about::Noisy;
use super::basis::{Basis, SOURCES, rest_norms};
use super::gates::{self, Gates};
use super::network::{Hidden, Network, WIDTH};
use super::scales::{EDGE, Phases};
use super::vectors::{Axes, combine, sources};
use super::{BASES, CELL, REACH};
use crate::clip::Planes;
use crate::parallel::{self, Interrupt};
use crate::simd::multiversion;
use crate::{ClipView, Error, Real};
use std::ops::Range;
use std::sync::Mutex;

/// What the gain of a frame takes of the cells before, at and after it, for each of its phases.
const BETWEEN: [[f32; 3]; CELL] =
    [[0.375, 0.625, 0.0], [0.125, 0.875, 0.0], [0.0, 0.875, 0.125], [0.0, 0.625, 0.375]];

/// Estimated nanoseconds per frame and joint of the vectors, of the powers, and of the gains.
const NANOSECONDS: [usize; 3] = [100, 100, 400];

/// What all blocks share.
#[derive(Debug)]
pub(super) struct Step<'a, T> {
    pub(super) noisy: &'a Noisy<'a, T>,
    pub(super) patches: ClipView<'a, T>,
    pub(super) joints: &'a [usize],
    pub(super) axes: &'a Axes,
    pub(super) network: &'a Network,
    pub(super) share: f64,
    /// What tasks that are done have left.
    pub(super) kept: Mutex<Vec<Scratch>>,
}

/// What one task writes on its way.
#[derive(Debug, Default)]
pub(super) struct Scratch {
    bases: [Basis; 3],
    gates: Gates,
    hidden: Hidden,
    power: Vec<f32>,
    gains: Planes<f32>,
    sums: Planes<f32>,
}

/// Cells of a block among those of the frames around it.
#[derive(Debug, Clone, Copy)]
struct Cells {
    /// Cells of all frames.
    all: usize,
    /// The block's.
    first: usize,
    count: usize,
    /// The first cell whose gains are computed, and how many blocks of the network.
    from: usize,
    blocks: usize,
}

impl Cells {
    fn new(around: &Range<usize>, block: &Range<usize>) -> Self {
        let all = around.len().div_ceil(CELL);
        let first = (block.start - around.start) / CELL;
        let count = block.len().div_ceil(CELL);
        let from = first.saturating_sub(1);
        let blocks = ((first + count + 1).min(all) - from).div_ceil(WIDTH);
        Self { all, first, count, from, blocks }
    }
}

impl<T: Real> Step<'_, T> {
    /// How far the result lies from the pilot, in units of the noise: three planes for each noisy joint.
    pub(super) fn moves(
        &self,
        block: Range<usize>,
        interrupt: &Interrupt,
    ) -> Result<Vec<Planes<f64>>, Error> {
        let frames = self.noisy.clip.frames();
        let around = block.start.saturating_sub(REACH)..(block.end + REACH).min(frames);
        let work = |stage: usize| around.len() * self.joints.len() * NANOSECONDS[stage];
        let tasks: Vec<(usize, &[[f32; 3]; 3])> =
            self.joints.iter().copied().zip(&self.axes.joints).collect();
        let mut columns = parallel::map(tasks, work(0), |_, (joint, axes)| {
            interrupt.check()?;
            Ok(sources(self.noisy, self.patches, joint, &around, axes))
        })?;
        self.project(&mut columns, around.len())?;
        let norms = rest_norms();
        let cells = Cells::new(&around, &block);
        let sums = parallel::map(columns.iter().collect(), work(1), |_, columns: &Phases| {
            interrupt.check()?;
            let mut scratch = take(&self.kept);
            let mut sums = Planes::new(BASES, cells.all);
            for axis in 0..3 {
                scratch.bases[0].compute(columns, axis, &norms);
                gates::add_powers(&scratch.bases[0], around.len(), &mut scratch.power, &mut sums);
            }
            give(&self.kept, scratch);
            Ok(sums)
        })?;
        let of_body = gates::of_body(&sums, 3 * sums.len());
        let of_body = self.network.body(&of_body, cells.from, cells.blocks);
        let tasks: Vec<(&Phases, &[[f32; 3]; 3])> = columns.iter().zip(&self.axes.joints).collect();
        parallel::map(tasks, work(2), |_, (columns, axes)| {
            interrupt.check()?;
            let mut scratch = take(&self.kept);
            scratch.gates.reset(cells.all);
            for axis in 0..3 {
                scratch.bases[axis].compute(columns, axis, &norms);
                scratch.gates.take(axis, &scratch.bases[axis], around.len());
            }
            scratch.gates.close_joint();
            scratch.find_gains(self.network, &of_body, cells);
            let moves = scratch.moves(axes, self.share, cells, block.len());
            give(&self.kept, scratch);
            Ok(moves)
        })
    }

    /// Projects the displacements to the samples on the strongest axes of the body.
    fn project(&self, columns: &mut [Phases], frames: usize) -> Result<(), Error> {
        let axes = &self.axes.body;
        let cells = frames.div_ceil(CELL);
        let work = frames * self.axes.of_body() * columns.len();
        let seen: &[Phases] = columns;
        let along = parallel::map((0..self.axes.of_body()).collect(), work, |_, vector: usize| {
            let mut along = Planes::<f32>::new(CELL, cells);
            for (columns, axes) in seen.iter().zip(axes) {
                for phase in 0..CELL {
                    let sum = along.row_mut(phase);
                    for (axis, components) in axes.iter().enumerate() {
                        let x = &columns.phase(axis, phase)[EDGE..EDGE + cells];
                        add_scaled(x, components[vector], sum);
                    }
                }
            }
            Ok(along)
        })?;
        parallel::for_each(
            columns.iter_mut().zip(axes).collect(),
            work,
            |_, (columns, axes): (&mut Phases, &[Vec<f32>; 3])| {
                for (axis, components) in axes.iter().enumerate() {
                    let column = 3 * (SOURCES - 1) + axis;
                    for phase in 0..CELL {
                        let out = &mut columns.phase_mut(column, phase)[EDGE..EDGE + cells];
                        for (along, &component) in along.iter().zip(components) {
                            add_scaled(along.row(phase), component, out);
                        }
                    }
                    columns.mirror_edges(column, frames);
                }
                Ok(())
            },
        )
    }
}

impl Scratch {
    /// Writes the gains of the block's cells, and of one more before and after, where there is one; else the next one stands there.
    fn find_gains(&mut self, network: &Network, of_body: &[f32], cells: Cells) {
        let Self { gates, hidden, gains, .. } = self;
        let lead = usize::from(cells.from == cells.first);
        gains.reshape(3 * BASES, (cells.blocks * WIDTH + 1).max(cells.count + 2));
        for (number, of_body) in of_body.chunks_exact(of_body.len() / cells.blocks).enumerate() {
            let first = cells.from + number * WIDTH;
            let found = network.gains(of_body, (&gates.own, &gates.joint), first, hidden);
            for axis in 0..3 {
                let found = &found[axis * Network::rows()..];
                for (vector, found) in found.chunks_exact(WIDTH).take(BASES).enumerate() {
                    gains.row_mut(axis * BASES + vector)[lead + number * WIDTH..][..WIDTH]
                        .copy_from_slice(found);
                }
            }
        }
        for row in 0..3 * BASES {
            let gains = gains.row_mut(row);
            if lead == 1 {
                gains[0] = gains[1];
            }
            if cells.first + cells.count == cells.all {
                gains[cells.count + 1] = gains[cells.count];
            }
        }
    }

    /// Gains times vectors, out of the axes of the joint.
    fn moves(&mut self, axes: &[[f32; 3]; 3], share: f64, cells: Cells, frames: usize) -> Planes<f64> {
        let Self { bases, gains, sums, power, .. } = self;
        sums.reshape(3, cells.count);
        power.resize(cells.count, 0.0);
        let mut result = Planes::new(3, frames);
        for (phase, weights) in BETWEEN.iter().enumerate() {
            for (axis, basis) in bases.iter().enumerate() {
                let sum = sums.row_mut(axis);
                sum.fill(0.0);
                for vector in 0..BASES {
                    let gains = gains.row(axis * BASES + vector);
                    let from = usize::from(phase >= CELL / 2);
                    let pair = [&gains[from..][..cells.count], &gains[from + 1..][..cells.count]];
                    let basis = &basis.phase(vector, phase)[cells.first..][..cells.count];
                    add_between(pair, [weights[from], weights[from + 1]], basis, sum);
                }
            }
            for (i, row) in axes.iter().enumerate() {
                combine(sums.rows_from::<3>(0), *row, power);
                for (out, value) in result.row_mut(i).iter_mut().skip(phase).step_by(CELL).zip(&*power) {
                    *out = f64::from(*value) * share;
                }
            }
        }
        result
    }
}

/// Scratch of a task that is done, or new.
fn take(kept: &Mutex<Vec<Scratch>>) -> Scratch {
    kept.lock().map_or(None, |mut kept| kept.pop()).unwrap_or_default()
}

fn give(kept: &Mutex<Vec<Scratch>>, scratch: Scratch) {
    if let Ok(mut kept) = kept.lock() {
        kept.push(scratch);
    }
}

multiversion! {
    fn add_scaled(values: &[f32], by: f32, out: &mut [f32]) {
        for (sum, value) in out.iter_mut().zip(values) {
            *sum += by * *value;
        }
    }
}

multiversion! {
    /// Adds a basis vector, times what two gains say together.
    fn add_between(gains: [&[f32]; 2], weights: [f32; 2], basis: &[f32], out: &mut [f32]) {
        let n = out.len();
        let (a, b, basis) = (&gains[0][..n], &gains[1][..n], &basis[..n]);
        for i in 0..n {
            out[i] += (weights[0] * a[i] + weights[1] * b[i]) * basis[i];
        }
    }
}
