//! Patches as points: the mean of a patch's frames, and the means of blocks of consecutive patches.

use super::axes::{Axes, GROUP};
use super::kernels::{self, LANES};
use super::stage::{Stage, above};
use super::{BLOCK, COLUMNS, TASK};
use crate::parallel::{self, Interrupt};
use crate::search::diagonal::Measure;
use crate::search::features::{Features, Side};
use crate::search::kernels::sliding_sums;
use crate::search::poses::{Segments, directions};
use crate::{Error, Real};

/// Number of directions of projection.
pub(super) const WIDTH: usize = 16;

/// The candidates as points.
#[derive(Debug)]
pub(super) struct Points<T> {
    pub(super) axes: Axes<T>,
    /// Length of a point: the number of coordinates, padded with zeros to whole vectors.
    pub(super) dims: usize,
    /// Directions of projection, `(WIDTH, dims)`.
    pub(super) basis: Vec<T>,
    /// Blocks, projected on the directions.
    pub(super) projections: Stage<T>,
    /// Blocks.
    pub(super) blocks: Stage<T>,
    /// Points, `(candidates, dims)`.
    pub(super) rows: Vec<T>,
    /// Half the squared lengths of the points.
    pub(super) halves: Vec<T>,
}

/// Points, blocks and projections of consecutive patches, as planes: one plane per coordinate.
#[derive(Debug, Default)]
pub(super) struct Summary<T> {
    count: usize,
    /// Length of a point.
    dims: usize,
    points: Vec<T>,
    blocks: Vec<T>,
    projections: Vec<T>,
    /// The squared lengths of the points, the blocks and the projections.
    pub(super) squares: [Vec<T>; 3],
    /// For each block, the distance of its farthest point from its mean.
    pub(super) radii: Vec<T>,
    /// The length of the longest frame vector, times the square root of the patch length in frames.
    pub(super) longest: T,
    planes: Vec<T>,
    values: Vec<T>,
    scratch: Vec<T>,
}

/// The [`GROUP`] planes from `first` on.
fn group<T>(planes: &[T], first: usize, length: usize) -> [&[T]; GROUP] {
    [0, 1, 2, 3].map(|i| &planes[(first + i) * length..(first + i + 1) * length])
}

/// Resizes to `length` zeros.
fn clear<T: Real>(numbers: &mut Vec<T>, length: usize) {
    numbers.clear();
    numbers.resize(length, T::ZERO);
}

impl<T: Real> Summary<T> {
    /// Reads `count` patches, from the one centred on the column `at`.
    pub(super) fn read(
        &mut self,
        axes: &Axes<T>,
        basis: &[T],
        measure: &Measure<T>,
        features: &Features<'_, T>,
        at: usize,
        count: usize,
    ) {
        let window = measure.window();
        let (length, start) = (count + window - 1, at - measure.before);
        let dims = axes.count().next_multiple_of(LANES);
        let Self { points, blocks, projections, squares, radii, planes, values, scratch, .. } = self;
        (self.count, self.dims) = (count, dims);
        let several = count.div_ceil(BLOCK);
        clear(points, dims * count);
        clear(blocks, dims * several);
        clear(projections, WIDTH * several);
        let [of_points, of_blocks, of_projections] = squares;
        clear(of_points, count);
        clear(of_blocks, several);
        clear(of_projections, several);
        clear(radii, several);
        if count == 0 {
            return;
        }
        let mut lengths = vec![T::ZERO; length];
        // A point is the sum over the patch divided by √window. By Cauchy–Schwarz, point distances are at most patch
        // distances.
        let share = T::from_f64(1.0 / (window as f64).sqrt());
        axes.each_group(features, start..start + length, planes, |axis, group| {
            kernels::add_squares(&mut lengths, group);
            for (plane, sums) in group.into_iter().zip(points[axis * count..].chunks_exact_mut(count)) {
                values.clear();
                values.extend_from_slice(plane);
                sliding_sums(values, scratch, window, sums);
                for sum in sums {
                    *sum *= share;
                }
            }
        });
        let longest = lengths.iter().fold(T::ZERO, |most, square| most.max(*square));
        self.longest = (longest * T::from_f64(window as f64)).sqrt();
        // A block is the mean of its points.
        for (plane, means) in points.chunks_exact(count).zip(blocks.chunks_exact_mut(several)) {
            for (mean, members) in means.iter_mut().zip(plane.chunks(BLOCK)) {
                let sum = members.iter().fold(T::ZERO, |sum, x| sum + *x);
                *mean = sum * T::from_f64(1.0 / members.len() as f64);
            }
        }
        // The radius of a block is the distance of its farthest point from that mean.
        let mut apart = vec![T::ZERO; count];
        for (plane, means) in points.chunks_exact(count).zip(blocks.chunks_exact(several)) {
            for ((members, mean), apart) in plane.chunks(BLOCK).zip(means).zip(apart.chunks_mut(BLOCK)) {
                for (sum, x) in apart.iter_mut().zip(members) {
                    *sum += (*x - *mean) * (*x - *mean);
                }
            }
        }
        for (radius, apart) in radii.iter_mut().zip(apart.chunks(BLOCK)) {
            *radius = apart.iter().fold(T::ZERO, |most, square| most.max(*square)).sqrt() * above::<T>();
        }
        for first in (0..dims).step_by(GROUP) {
            kernels::add_squares(of_points, group(points, first, count));
            let planes = group(blocks, first, several);
            kernels::add_squares(of_blocks, planes);
            for (projection, vector) in projections.chunks_exact_mut(several).zip(basis.chunks_exact(dims)) {
                let by = [vector[first], vector[first + 1], vector[first + 2], vector[first + 3]];
                kernels::add_combination(projection, planes, by);
            }
        }
        for first in (0..WIDTH).step_by(GROUP) {
            kernels::add_squares(of_projections, group(projections, first, several));
        }
    }

    /// Writes the points, row by row.
    pub(super) fn write_points(&self, rows: &mut [T]) {
        write(&self.points, self.count, rows);
    }

    /// Writes the blocks, row by row.
    pub(super) fn write_blocks(&self, rows: &mut [T]) {
        write(&self.blocks, self.radii.len(), rows);
    }

    /// Writes the projections of the blocks, row by row.
    pub(super) fn write_projections(&self, rows: &mut [T]) {
        write(&self.projections, self.radii.len(), rows);
    }

    /// Runs `work(first, planes)` for each group of coordinates of the blocks or of their projections.
    fn each_group(&self, projections: bool, mut work: impl FnMut(usize, [&[T]; GROUP])) {
        let (planes, dims) = if projections { (&self.projections, WIDTH) } else { (&self.blocks, self.dims) };
        for first in (0..dims).step_by(GROUP) {
            work(first, group(planes, first, self.radii.len()));
        }
    }
}

/// Transposes planes of `length` elements into rows.
fn write<T: Real>(planes: &[T], length: usize, rows: &mut [T]) {
    if length == 0 {
        return;
    }
    let dims = planes.len() / length;
    for (number, plane) in planes.chunks_exact(length).enumerate() {
        for (row, x) in rows.chunks_exact_mut(dims).zip(plane) {
            row[number] = *x;
        }
    }
}

impl<T: Real> Points<T> {
    /// Reads the candidates of a side; the directions come from a sample of their columns.
    pub(super) fn new(
        axes: Axes<T>,
        sample: &[usize],
        measure: &Measure<T>,
        side: &Side<'_, T>,
        interrupt: &Interrupt,
    ) -> Result<Self, Error> {
        let dims = axes.count().next_multiple_of(LANES);
        let mut numbers = vec![T::ZERO; sample.len() * dims];
        for (row, &column) in numbers.chunks_exact_mut(dims).zip(sample) {
            axes.read(&side.features, column, row);
        }
        let segments = Segments::new(&numbers, dims, &[0, sample.len()], 1, 0)?;
        let basis: Vec<T> = directions(&segments, WIDTH).into_iter().map(T::from_f64).collect();
        let blocks = side.count.div_ceil(BLOCK);
        let per_tile = COLUMNS / BLOCK;
        let mut projections = Stage::new(measure, WIDTH, WIDTH / GROUP, blocks, per_tile, 0);
        let mut several = Stage::new(measure, dims, dims / GROUP, blocks, per_tile, 0);
        let mut rows = vec![T::ZERO; side.count * dims];
        let tasks: Vec<_> = projections
            .tasks(TASK / BLOCK)
            .into_iter()
            .zip(several.tasks(TASK / BLOCK))
            .zip(rows.chunks_mut(TASK * dims))
            .collect();
        let parts =
            parallel::map(tasks, side.count * dims * 8, |task, ((mut projections, mut blocks), rows)| {
                interrupt.check()?;
                let first = task * TASK;
                let mut summary = Summary::default();
                summary.read(&axes, &basis, measure, &side.features, side.at + first, rows.len() / dims);
                summary.write_points(rows);
                summary.each_group(true, |first, group| projections.write(first, group));
                summary.each_group(false, |first, group| blocks.write(first, group));
                Ok((summary.squares, summary.radii, summary.longest))
            })?;
        let longest = parts.iter().fold(T::ZERO, |most, (.., longest)| most.max(*longest));
        let squares = |i: usize| parts.iter().flat_map(|(squares, ..)| &squares[i]).copied().collect();
        let radii: Vec<T> = parts.iter().flat_map(|(_, radii, _)| radii).copied().collect();
        let (mut of_points, of_blocks, of_projections): (Vec<T>, Vec<T>, Vec<T>) =
            (squares(0), squares(1), squares(2));
        for (stage, squares) in [(&mut projections, of_projections), (&mut several, of_blocks)] {
            stage.project(dims + measure.window(), longest);
            stage.add_up(&squares, 1);
            stage.set_radii(&radii);
        }
        let mut halves = vec![T::ZERO; side.count];
        several.half(&mut of_points, 1, &mut halves);
        Ok(Self { axes, dims, basis, projections, blocks: several, rows, halves })
    }
}
