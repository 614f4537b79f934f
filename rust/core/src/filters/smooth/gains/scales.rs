//! Versions of a plane, each smoother than the one before: cubic splines with holes.
//!
//! Frames are laid out by phase: the frame `t` is the number `t / CELL` of the plane `t % CELL`. All masks, the means over cells and
//! the gains then read and write whole planes, whatever the hole.

use super::CELL;
use crate::clip::Planes;
use crate::simd::multiversion;

/// Numbers before and after a plane that smoothing may read: as many cells as the widest scale of frames reaches.
pub(super) const EDGE: usize = 32;

/// Cells before and after a plane of cells that the widest scale of cells reaches, and two more.
pub(super) const CELL_EDGE: usize = 64;

/// Frames per phase and joint: a clip or a piece of it, with edges, in `CELL` planes for each of several columns.
#[derive(Debug, Default)]
pub(super) struct Phases {
    planes: Planes<f32>,
}

impl Phases {
    /// Room for `columns` columns of `cells` cells without their edges.
    pub(super) fn reshape(&mut self, columns: usize, cells: usize) {
        self.planes.reshape(columns * CELL, cells + 2 * EDGE);
    }

    /// Takes a column of frames; beyond its ends it is mirrored, or 0.
    pub(super) fn load(&mut self, column: usize, frames: &[f32], mirrored: bool) {
        let (cells, rest) = frames.as_chunks::<CELL>();
        let phases: [&mut [f32]; CELL] = self.planes.rows_mut(column * CELL);
        for (phase, plane) in phases.into_iter().enumerate() {
            plane.fill(0.0);
            for (value, cell) in plane[EDGE..].iter_mut().zip(cells) {
                *value = cell[phase];
            }
            if let Some(&value) = rest.get(phase) {
                plane[EDGE + cells.len()] = value;
            }
        }
        if mirrored {
            self.mirror_edges(column, frames.len());
        }
    }

    /// Mirrors a column of so many frames at both ends.
    pub(super) fn mirror_edges(&mut self, column: usize, frames: usize) {
        let length = self.phase(column, 0).len();
        for phase in 0..CELL {
            let end = EDGE + (frames + CELL - 1 - phase) / CELL;
            for cell in (0..EDGE).chain(end..length) {
                let frame = (cell * CELL + phase).cast_signed() - (EDGE * CELL).cast_signed();
                let source = mirror(frame, frames);
                let value = self.phase(column, source % CELL)[EDGE + source / CELL];
                self.phase_mut(column, phase)[cell] = value;
            }
        }
    }

    /// One phase of a column, with its edges.
    pub(super) fn phase(&self, column: usize, phase: usize) -> &[f32] {
        self.planes.row(column * CELL + phase)
    }

    /// One phase of a column, to be written.
    pub(super) fn phase_mut(&mut self, column: usize, phase: usize) -> &mut [f32] {
        self.planes.row_mut(column * CELL + phase)
    }

    /// The numbers `margin` cells away from the ends, `shift` frames later.
    fn tap(&self, column: usize, (phase, shift): (usize, isize), margin: usize) -> &[f32] {
        let frame = phase.cast_signed() + shift;
        let plane = self.phase(column, frame.rem_euclid(CELL.cast_signed()).unsigned_abs());
        let first = margin.cast_signed() + frame.div_euclid(CELL.cast_signed());
        &plane[first.unsigned_abs()..][..plane.len() - 2 * margin]
    }
}

/// The frame that stands beyond the ends of so many, mirrored as often as it takes.
fn mirror(frame: isize, frames: usize) -> usize {
    let index = frame.rem_euclid(2 * frames.cast_signed()).unsigned_abs();
    if index < frames { index } else { 2 * frames - 1 - index }
}

/// Scales of one column of frames.
#[derive(Debug, Default)]
pub(super) struct Ladder {
    rungs: Vec<Phases>,
}

impl Ladder {
    /// Computes `count` scales of a column, at least one.
    pub(super) fn climb(&mut self, from: &Phases, column: usize, count: usize) {
        self.rungs.resize_with(count.max(self.rungs.len()), Phases::default);
        let length = from.phase(column, 0).len();
        for scale in 0..count {
            let (before, rest) = self.rungs.split_at_mut(scale);
            let (source, column) = before.last().map_or((from, column), |rung| (rung, 0));
            let hole = 1_isize << scale;
            // The scale k reaches 2(2ᵏ − 1) frames.
            let margin = (2 * (2 * hole - 1)).unsigned_abs().div_ceil(CELL);
            let to = &mut rest[0];
            to.reshape(1, length - 2 * EDGE);
            for phase in 0..CELL {
                let taps = [-2, -1, 0, 1, 2].map(|tap| source.tap(column, (phase, tap * hole), margin));
                let out = &mut to.phase_mut(0, phase)[margin..length - margin];
                spline(taps, out);
            }
        }
    }

    /// One phase of the scale `scale`, without edges.
    pub(super) fn scale(&self, scale: usize, phase: usize) -> &[f32] {
        let plane = self.rungs[scale - 1].phase(0, phase);
        &plane[EDGE..plane.len() - EDGE]
    }
}

/// Scales of one plane of cells.
#[derive(Debug, Default)]
pub(super) struct CellLadder {
    rungs: Planes<f32>,
}

impl CellLadder {
    /// Computes `count` scales of a plane of cells, mirrored at both ends.
    pub(super) fn climb(&mut self, cells: &[f32], count: usize) {
        let length = cells.len() + 2 * CELL_EDGE;
        self.rungs.reshape(count + 1, length);
        let around = self.rungs.row_mut(0);
        around[CELL_EDGE..][..cells.len()].copy_from_slice(cells);
        for i in 0..CELL_EDGE {
            around[i] = cells[mirror(i.cast_signed() - CELL_EDGE.cast_signed(), cells.len())];
            let after = cells.len() + i;
            around[CELL_EDGE + after] = cells[mirror(after.cast_signed(), cells.len())];
        }
        for scale in 0..count {
            let hole = 1 << scale;
            let margin = 2 * (2 * hole - 1);
            let [source, to] = self.rungs.rows_mut::<2>(scale);
            let size = length - 2 * margin;
            let taps = [0, 1, 2, 3, 4].map(|tap| &source[margin - 2 * hole + tap * hole..][..size]);
            spline(taps, &mut to[margin..][..size]);
        }
    }

    /// The scale `scale`; 0 are the cells.
    pub(super) fn scale(&self, scale: usize) -> &[f32] {
        let plane = self.rungs.row(scale);
        &plane[CELL_EDGE..plane.len() - CELL_EDGE]
    }
}

multiversion! {
    /// The mask (1, 4, 6, 4, 1) / 16.
    fn spline(taps: [&[f32]; 5], out: &mut [f32]) {
        let n = out.len();
        let [a, b, c, d, e] = taps;
        let (a, b, c, d, e) = (&a[..n], &b[..n], &c[..n], &d[..n], &e[..n]);
        for i in 0..n {
            out[i] = ((a[i] + e[i]) + 4.0 * (b[i] + d[i]) + 6.0 * c[i]) * 0.0625;
        }
    }
}
