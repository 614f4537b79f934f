//! Coordinates of a few consecutive frames, compared with all candidates.

use super::axes::GROUP;
use super::kernels::{self, Columns, LANES, Row, TALL};
use super::points::{Points, Summary, WIDTH};
use super::stage::Stage;
use super::{BLOCK, Bounds, COLUMNS};
use crate::Real;
use crate::search::diagonal::Measure;
use crate::search::features::Side;
use crate::search::kernels::sums_along;
use std::ops::Range;

/// The chord bound is evaluated for a whole part of a tile if at least one in `DENSE` of its pairs of blocks survives
/// the point bound.
const DENSE: usize = 8;

/// Coordinates row by row, and their bound data.
#[derive(Debug, Default)]
struct Rows<T> {
    numbers: Vec<T>,
    halves: Vec<T>,
    known: Vec<Row<T>>,
}

impl<T: Real> Rows<T> {
    fn reset(&mut self, rows: usize, dims: usize) -> &mut [T] {
        self.numbers.clear();
        self.numbers.resize(rows.next_multiple_of(TALL) * dims, T::ZERO);
        &mut self.numbers
    }

    fn halve(&mut self, stage: &Stage<T>, squares: &mut Vec<T>, window: usize) {
        self.halves.resize(squares.len() + 1 - window, T::ZERO);
        stage.half(squares, window, &mut self.halves);
    }

    fn know(&mut self, limits: impl Iterator<Item = T>, radii: impl Iterator<Item = T>) {
        self.known.clear();
        let halves = self.halves.iter();
        self.known.extend(halves.zip(limits).zip(radii).map(|((half, limit), radius)| Row {
            half: *half,
            limit,
            radius,
        }));
    }
}

/// Limits of the candidates of a tile, one array per bound.
#[derive(Debug, Default)]
struct Limits<T> {
    chords: Vec<T>,
    blocks: Vec<T>,
    points: Vec<T>,
}

/// At most [`ROWS`](super::ROWS) frames, and scratch memory for comparing them with a tile.
#[derive(Debug, Default)]
pub(crate) struct Strip<T> {
    frames: usize,
    chords: Rows<T>,
    projections: Rows<T>,
    blocks: Rows<T>,
    points: Rows<T>,
    others: Limits<T>,
    summary: Summary<T>,
    products: Vec<T>,
    sums: Vec<T>,
    scratch: Vec<T>,
    marks: Vec<u8>,
    near: Vec<(usize, usize)>,
}

impl<T: Real> Strip<T> {
    /// Reads frames of a side.
    pub(crate) fn load(
        &mut self,
        bounds: &Bounds<T>,
        measure: &Measure<T>,
        side: &Side<'_, T>,
        frames: Range<usize>,
    ) {
        self.frames = frames.len();
        let (at, features) = (side.at + frames.start, &side.features);
        if let Some((axes, stage)) = &bounds.chords {
            let start = at - measure.before;
            let length = frames.len() + stage.border;
            let mut squares = vec![T::ZERO; length];
            let rows = self.chords.reset(length, stage.dims);
            axes.each_group(features, start..start + length, &mut self.scratch, |first, [a, b, c, d]| {
                kernels::add_squares(&mut squares, [a, b, c, d]);
                for (i, row) in rows.chunks_exact_mut(stage.dims).take(length).enumerate() {
                    row[first..first + GROUP].copy_from_slice(&[a[i], b[i], c[i], d[i]]);
                }
            });
            self.chords.halve(stage, &mut squares, measure.window());
        }
        if let Some(points) = &bounds.points {
            let Self { projections, blocks, points: own, summary, .. } = self;
            summary.read(&points.axes, &points.basis, measure, features, at, frames.len());
            let count = summary.radii.len();
            summary.write_projections(projections.reset(count, WIDTH));
            summary.write_blocks(blocks.reset(count, points.dims));
            summary.write_points(own.reset(frames.len(), points.dims));
            let [of_points, of_blocks, of_projections] = &mut summary.squares;
            own.halve(&points.blocks, of_points, 1);
            blocks.halve(&points.blocks, of_blocks, 1);
            projections.halve(&points.projections, of_projections, 1);
        }
    }

    /// Sets the frames' limits: the distance of each frame's farthest neighbour found so far.
    pub(crate) fn limit(&mut self, bounds: &Bounds<T>, limits: &[T]) {
        if let Some((_, stage)) = &bounds.chords {
            let limits = limits.iter().map(|limit| stage.reach(*limit, T::ZERO));
            self.chords.know(limits, std::iter::repeat(T::ZERO));
        }
        if let Some(points) = &bounds.points {
            let Self { projections, blocks, points: own, summary, .. } = self;
            let reach = |limit: T| points.blocks.reach(limit, summary.longest);
            own.know(limits.iter().map(|limit| reach(*limit)), std::iter::repeat(T::ZERO));
            for rows in [blocks, projections] {
                rows.know(
                    limits.chunks(BLOCK).map(|limits| reach(farthest(limits))),
                    summary.radii.iter().copied(),
                );
            }
        }
    }

    /// Sets the limits of the candidates of a tile; 0 where a candidate needs no neighbours.
    pub(crate) fn limit_others(&mut self, bounds: &Bounds<T>, limits: &[T; COLUMNS]) {
        let Limits { chords, blocks, points } = &mut self.others;
        if let Some((_, stage)) = &bounds.chords {
            chords.clear();
            chords.extend(limits.iter().map(|limit| stage.reach(*limit, T::ZERO)));
        }
        if let Some(other) = &bounds.points {
            let reach = |limit: T| other.blocks.reach(limit, self.summary.longest);
            points.clear();
            points.extend(limits.iter().map(|limit| reach(*limit)));
            blocks.clear();
            blocks.extend(limits.chunks(BLOCK).map(|limits| reach(farthest(limits))));
        }
    }

    /// Runs `work(frame, candidate)` for the pairs of the strip with a tile of candidates that survive the bounds.
    pub(crate) fn sift(&mut self, bounds: &Bounds<T>, tile: usize, mut work: impl FnMut(usize, usize)) {
        let first = tile * COLUMNS;
        let (mut rows, mut columns) = (0..self.frames, first..first + COLUMNS);
        if let Some(points) = &bounds.points {
            let Some(part) = self.part(&points.projections, tile) else { return };
            self.near_blocks(&points.blocks, tile, &part);
            rows = part.0.start * BLOCK..self.frames.min(part.0.end * BLOCK);
            columns = part.1.start * BLOCK..part.1.end * BLOCK;
            let all = part.0.len() * part.1.len();
            if bounds.chords.is_none() || self.near.len() * DENSE < all {
                self.near_points(points, first, work);
                return;
            }
        }
        if let Some((_, stage)) = &bounds.chords {
            self.near_chords(stage, first, rows, columns, &mut work);
        }
    }

    /// The smallest range of block rows and columns of a tile that contains all pairs whose projections are near
    /// enough.
    fn part(&mut self, stage: &Stage<T>, tile: usize) -> Option<(Range<usize>, Range<usize>)> {
        let width = COLUMNS / BLOCK;
        let Self { projections, products, marks, others, .. } = self;
        let (first, tall) = (tile * width, projections.numbers.len() / WIDTH);
        products.resize(tall * width, T::ZERO);
        let panels = &stage.panels[first * WIDTH..(first + width) * WIDTH];
        kernels::products(products, &projections.numbers, panels, WIDTH, stage.signed);
        let columns = known(stage, first..first + width, &others.blocks);
        marks.resize(projections.known.len(), 0);
        kernels::mark_rows(marks, products, &projections.known, columns);
        let rows = marked(marks)?;
        marks.resize(width / LANES, 0);
        let within = &products[rows.start * width..rows.end * width];
        kernels::mark_panels(marks, within, &projections.known[rows.clone()], columns);
        let panels = marked(marks)?;
        // Round down to whole tiles of rows.
        Some((rows.start / TALL * TALL..rows.end, first + panels.start * LANES..first + panels.end * LANES))
    }

    /// Finds the pairs of blocks that survive the point bound.
    fn near_blocks(&mut self, stage: &Stage<T>, tile: usize, (rows, columns): &(Range<usize>, Range<usize>)) {
        let Self { blocks, products, marks, near, others, .. } = self;
        let (tall, width) = (rows.len().next_multiple_of(TALL), columns.len());
        products.resize(tall * width, T::ZERO);
        let numbers = &blocks.numbers[rows.start * stage.dims..(rows.start + tall) * stage.dims];
        let panels = &stage.panels[columns.start * stage.dims..columns.end * stage.dims];
        kernels::products(products, numbers, panels, stage.dims, stage.signed);
        let limits = &others.blocks[columns.start - tile * (COLUMNS / BLOCK)..];
        let known = known(stage, columns.clone(), limits);
        marks.resize(width, 0);
        near.clear();
        for (row, products) in rows.clone().zip(products.chunks_exact(width)) {
            if kernels::mark_products(marks, products, blocks.known[row], known) {
                each_mark(marks, |column| near.push((row, columns.start + column)));
            }
        }
    }

    /// Evaluates the point bound for each pair of patches in the pairs of blocks found.
    fn near_points(&self, points: &Points<T>, first: usize, mut work: impl FnMut(usize, usize)) {
        let dims = points.dims;
        let own = &self.points;
        for &(row, column) in &self.near {
            let (row, column) = (row * BLOCK, column * BLOCK);
            let (row_end, column_end) =
                (self.frames.min(row + BLOCK), points.halves.len().min(column + BLOCK));
            let ours = [row, row_end - 1].map(|row| &own.numbers[row * dims..(row + 1) * dims]);
            let others =
                [column, column_end - 1].map(|column| &points.rows[column * dims..(column + 1) * dims]);
            let products = kernels::four_products(ours, others);
            for (row, products) in (row..row_end).zip(products) {
                let known = own.known[row];
                for (column, product) in (column..column_end).zip(products) {
                    let limit = known.limit.max(self.others.points[column - first]);
                    if product + T::HALF * limit * limit >= known.half + points.halves[column] {
                        work(row, column);
                    }
                }
            }
        }
    }

    /// Evaluates the chord bound for all pairs of the given rows and columns.
    fn near_chords(
        &mut self,
        stage: &Stage<T>,
        first: usize,
        rows: Range<usize>,
        columns: Range<usize>,
        work: &mut impl FnMut(usize, usize),
    ) {
        let Self { chords, products, sums, scratch, marks, others, .. } = self;
        let width = (columns.len() + stage.border).next_multiple_of(LANES);
        let tall = (rows.len() + stage.border).next_multiple_of(TALL);
        let numbers = &chords.numbers[rows.start * stage.dims..(rows.start + tall) * stage.dims];
        products.resize(tall * width, T::ZERO);
        let panels = &stage.panels[columns.start * stage.dims..(columns.start + width) * stage.dims];
        kernels::products(products, numbers, panels, stage.dims, stage.signed);
        sums.resize((rows.len() - 1) * width + columns.len(), T::ZERO);
        sums_along(products, scratch, stage.border + 1, width + 1, sums);
        let known = known(stage, columns.clone(), &others.chords[columns.start - first..]);
        marks.resize(columns.len(), 0);
        for (row, sums) in rows.zip(sums.chunks(width)) {
            if kernels::mark_products(marks, sums, chords.known[row], known) {
                each_mark(marks, |column| work(row, columns.start + column));
            }
        }
    }
}

/// The largest limit.
fn farthest<T: Real>(limits: &[T]) -> T {
    limits.iter().fold(T::ZERO, |most, limit| most.max(*limit))
}

/// Bound data of a range of candidates; `limits` starts at the first of them.
fn known<'a, T: Real>(stage: &'a Stage<T>, columns: Range<usize>, limits: &'a [T]) -> Columns<'a, T> {
    let limits = &limits[..columns.len()];
    Columns { halves: &stage.halves[columns.clone()], limits, radii: &stage.radii[columns] }
}

/// The range from the first mark to the last.
fn marked(marks: &[u8]) -> Option<Range<usize>> {
    let first = marks.iter().position(|mark| *mark != 0)?;
    let last = marks.iter().rposition(|mark| *mark != 0)?;
    Some(first..last + 1)
}

/// Runs `work(index)` for each mark. Marks are sparse, and their number is a multiple of [`LANES`].
fn each_mark(marks: &[u8], mut work: impl FnMut(usize)) {
    for (group, near) in marks.as_chunks::<LANES>().0.iter().enumerate() {
        if u128::from_ne_bytes(*near) == 0 {
            continue;
        }
        for (i, mark) in near.iter().enumerate() {
            if *mark != 0 {
                work(group * LANES + i);
            }
        }
    }
}
