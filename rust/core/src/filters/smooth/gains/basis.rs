//! The vectors of several scales that gains are given to, for one column.

use super::scales::{EDGE, Ladder, Phases};
use super::{BASES, CELL, COARSE, ESTIMATES, FINE, OF_REST, SCALES};
use crate::clip::Planes;
use crate::simd::multiversion;

/// Columns of one joint along one of its axes: first the displacement to the samples, then the development of the pilot, then the
/// displacements to other estimates.
pub(super) const SOURCES: usize = 2 + ESTIMATES;

/// Basis vectors of one column, by phase, and what makes them.
#[derive(Debug, Default)]
pub(super) struct Basis {
    found: Planes<f32>,
    ladder: Ladder,
}

impl Basis {
    /// One phase of a basis vector.
    pub(super) fn phase(&self, vector: usize, phase: usize) -> &[f32] {
        self.found.row(vector * CELL + phase)
    }

    /// Computes them for the axis `axis`; the column of the source `s` is `3 s + axis`.
    pub(super) fn compute(&mut self, sources: &Phases, axis: usize, norms: &[f32; OF_REST]) {
        let cells = sources.phase(0, 0).len() - 2 * EDGE;
        let Self { found, ladder } = self;
        found.reshape(BASES * CELL, cells);
        let mut write = |vector: usize, phase: usize, a: &[f32], b: &[f32], scale: f32| {
            difference(a, b, scale, found.row_mut(vector * CELL + phase));
        };
        let zeros = vec![0.0; cells];
        for source in 0..SOURCES {
            let column = 3 * source + axis;
            let count = if source < 2 { SCALES } else { COARSE };
            ladder.climb(sources, column, count);
            for phase in 0..CELL {
                let own = &sources.phase(column, phase)[EDGE..EDGE + cells];
                let scale = |k: usize| if k == 0 { own } else { ladder.scale(k, phase) };
                if source < 2 {
                    for (k, norm) in norms[..SCALES].iter().enumerate() {
                        let by = if source == 0 { norm.recip() } else { 1.0 };
                        write(source * OF_REST + k, phase, scale(k), scale(k + 1), by);
                    }
                    if source == 0 {
                        write(SCALES, phase, scale(SCALES), &zeros, norms[SCALES].recip());
                    }
                } else {
                    let first = OF_REST + SCALES + 3 * (source - 2);
                    write(first, phase, own, scale(FINE), 1.0);
                    write(first + 1, phase, scale(FINE), scale(COARSE), 1.0);
                    write(first + 2, phase, scale(COARSE), &zeros, 1.0);
                }
            }
        }
    }

    /// Writes the mean over each cell of the product of two basis vectors; of `frames` frames the last cell may have fewer.
    pub(super) fn cell_means(&self, a: usize, b: usize, frames: usize, out: &mut [f32]) {
        let [a, b] = [a, b].map(|vector| self.found.rows_from::<CELL>(vector * CELL));
        products(a, b, out);
        let (last, rest) = (frames / CELL, frames % CELL);
        if rest > 0 {
            let sum: f32 = (0..rest).map(|phase| a[phase][last] * b[phase][last]).sum();
            out[last] = sum / rest as f32;
        }
    }
}

/// Norms of the impulse responses of the scales of the displacement to the samples.
pub(super) fn rest_norms() -> [f32; OF_REST] {
    let size = 4 << SCALES;
    let mut impulse = vec![0.0_f64; size];
    impulse[size / 2] = 1.0;
    std::array::from_fn(|scale| {
        let before = impulse.clone();
        let hole = 1 << scale;
        let at = |i: usize, shift: usize| {
            (i + shift).checked_sub(2 * hole).and_then(|i| before.get(i)).copied().unwrap_or(0.0)
        };
        for (i, value) in impulse.iter_mut().enumerate() {
            let [a, b, c, d, e] = [0, 1, 2, 3, 4].map(|tap| at(i, tap * hole));
            *value = ((a + e) + 4.0 * (b + d) + 6.0 * c) / 16.0;
        }
        let smoother = |i: usize| if scale < SCALES { impulse[i] } else { 0.0 };
        let square: f64 = before.iter().enumerate().map(|(i, x)| (x - smoother(i)) * (x - smoother(i))).sum();
        <f32 as crate::Real>::from_f64(square.sqrt())
    })
}

multiversion! {
    fn difference(a: &[f32], b: &[f32], scale: f32, out: &mut [f32]) {
        let n = out.len();
        let (a, b) = (&a[..n], &b[..n]);
        for i in 0..n {
            out[i] = (a[i] - b[i]) * scale;
        }
    }
}

multiversion! {
    fn products(a: [&[f32]; CELL], b: [&[f32]; CELL], out: &mut [f32]) {
        let n = out.len();
        let (a, b) = (a.map(|plane| &plane[..n]), b.map(|plane| &plane[..n]));
        for i in 0..n {
            let (p, q) = (a[0][i] * b[0][i] + a[1][i] * b[1][i], a[2][i] * b[2][i] + a[3][i] * b[3][i]);
            out[i] = (p + q) * 0.25;
        }
    }
}
