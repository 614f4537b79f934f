//! The patches of a task, and the averages of a pass.

use super::super::about::About;
use super::cosines::Cosines;
use super::groups::groups;
use super::nearest::{self, Nearest};
use super::wiener::{System, width};
use super::{COEFFICIENTS, LENGTH, NANOSECONDS, RADIUS, STEP};
use crate::Error;
use crate::clip::Planes;
use crate::parallel::{self, Interrupt};
use std::ops::Range;
use std::sync::Mutex;

/// Estimated patches of a task.
const TASK: usize = 64;

/// Estimated patches of a pass.
const PASS: usize = 16 * TASK;

/// Estimated patches of a pass that may reach into the next one.
const CARRIED: usize = LENGTH / STEP;

/// What all tasks of a round share.
struct Round<'a> {
    about: &'a About,
    cosines: &'a Cosines,
    /// How many patches the clip has.
    patches: usize,
}

/// Memory that goes from task to task.
#[derive(Default)]
struct Buffers {
    columns: Vec<f64>,
    /// A plane for each number of a patch.
    planes: Planes<f64>,
    /// The same, a row for each patch.
    rows: Planes<f64>,
    nearest: Nearest,
    system: Option<System>,
}

/// Makes one step: in the place of the vectors from the pilot to the samples come those from the pilot to the estimates.
pub(super) fn improve(about: &mut About, frames: usize, interrupt: &Interrupt) -> Result<(), Error> {
    let groups = groups(&about.mean, frames, interrupt)?;
    let cosines = Cosines::new();
    let last = frames - LENGTH;
    let starts: Vec<usize> = (0..last).step_by(STEP).chain([last]).collect();
    let numbers = groups[0].len() * 3 * COEFFICIENTS;
    // For each joint, the groups that it is in, and as which of their members.
    let mut places = vec![Vec::new(); groups.len()];
    for (group, members) in groups.iter().enumerate() {
        for (member, &joint) in members.iter().enumerate() {
            places[joint].push((group, member));
        }
    }
    let row = (CARRIED + PASS.min(starts.len())) * numbers;
    let mut estimates = vec![0.0; groups.len() * row];
    let kept: Mutex<Vec<Buffers>> = Mutex::default();
    let mut settled = 0;
    for (pass, own) in starts.chunks(PASS).enumerate() {
        let first = pass * PASS;
        let round = Round { about, cosines: &cosines, patches: last + 1 };
        let tasks: Vec<(&[usize], &[usize], &mut [f64])> = estimates
            .chunks_mut(row)
            .zip(&groups)
            .flat_map(|(estimates, members)| {
                let tiles = estimates[CARRIED * numbers..].chunks_mut(TASK * numbers);
                own.chunks(TASK).zip(tiles).map(move |(starts, tile)| (&members[..], starts, tile))
            })
            .collect();
        let work = own.len() * STEP * groups.len() * NANOSECONDS;
        parallel::for_each(tasks, work, |_, (members, starts, out)| {
            interrupt.check()?;
            let mut buffers = kept.lock().map_or(None, |mut kept| kept.pop()).unwrap_or_default();
            estimate(&round, members, starts, out, &mut buffers);
            if let Ok(mut kept) = kept.lock() {
                kept.push(buffers);
            }
            Ok(())
        })?;
        // No later patch holds the frames before the next one begins, and they are not needed as they were.
        let end = starts.get(first + own.len()).copied().unwrap_or(frames);
        let carried = CARRIED.min(first);
        let held = &starts[first - carried..first + own.len()];
        let from = (CARRIED - carried) * numbers;
        let estimates_of = |group: usize| &estimates[group * row + from..(group + 1) * row];
        parallel::for_each(
            about.beside.iter_mut().collect(),
            (end - settled) * groups.len() * 100,
            |joint, beside: &mut Planes<f64>| {
                let sources = places[joint].iter().map(|&(group, member)| {
                    (estimates_of(group), member * 3 * COEFFICIENTS..(member + 1) * 3 * COEFFICIENTS)
                });
                average(&cosines, held, sources, numbers, settled..end, beside.rows_mut::<3>(0));
                Ok(())
            },
        )?;
        settled = end;
        for estimates in estimates.chunks_mut(row) {
            estimates.copy_within(own.len() * numbers..(own.len() + CARRIED) * numbers, 0);
        }
    }
    Ok(())
}

/// Estimates the patches of a group that begin at `starts`: a row of numbers for each, its difference from the pilot's.
fn estimate(
    round: &Round<'_>,
    members: &[usize],
    starts: &[usize],
    out: &mut [f64],
    Buffers { columns, planes, rows, nearest, system }: &mut Buffers,
) {
    let (Some(earliest), Some(latest)) = (starts.first(), starts.last()) else { return };
    let first = earliest.saturating_sub(RADIUS);
    let end = (latest + RADIUS + 1).min(round.patches);
    let numbers = members.len() * 3 * COEFFICIENTS;
    let width = width(numbers);
    planes.reshape(numbers, (end - first).next_multiple_of(nearest::BLOCK) + nearest::BLOCK);
    columns.resize(planes.length() + LENGTH - 1, 0.0);
    for (i, column) in members.iter().flat_map(|&joint| round.about.mean[joint].rows_from::<3>(0)).enumerate()
    {
        let column = &column[first..end + LENGTH - 1];
        columns[..column.len()].copy_from_slice(column);
        columns[column.len()..].fill(0.0);
        round.cosines.of_all(columns, planes.rows_mut::<COEFFICIENTS>(i * COEFFICIENTS));
    }
    rows.reshape(1, (end - first) * width);
    transpose(planes, width, rows.row_mut(0));
    let system = system.get_or_insert_with(|| System::new(numbers));
    for (&start, out) in starts.iter().zip(out.chunks_exact_mut(numbers)) {
        let rest = members.iter().flat_map(|&joint| round.about.beside[joint].rows_from::<3>(0));
        for (column, out) in rest.zip(out.chunks_exact_mut(COEFFICIENTS)) {
            round.cosines.of_one(&column[start..start + LENGTH], out);
        }
        let window = start.saturating_sub(RADIUS)..(start + RADIUS + 1).min(round.patches);
        let alike = nearest.find(planes, start - first, window.start - first, window.end - first);
        system.estimate(rows.row(0), alike, start - first, out);
    }
}

/// From planes to rows of `width` numbers; those beyond the planes are 0.
fn transpose(planes: &Planes<f64>, width: usize, rows: &mut [f64]) {
    for (i, row) in rows.chunks_exact_mut(width).enumerate() {
        for (number, x) in row.iter_mut().enumerate() {
            *x = if number < planes.rows() { planes.row(number)[i] } else { 0.0 };
        }
    }
}

/// Averages what the patches that begin at `starts` say about the frames of `range`, over all groups that a joint is in.
///
/// Each group has a row of `numbers` for each patch, in which those of the joint have their place.
fn average<'a>(
    cosines: &Cosines,
    starts: &[usize],
    sources: impl Iterator<Item = (&'a [f64], Range<usize>)>,
    numbers: usize,
    range: Range<usize>,
    out: [&mut [f64]; 3],
) {
    let [x, y, z] = out.map(|out| &mut out[range.clone()]);
    let mut out = [x, y, z];
    let mut counts = vec![0.0; range.len()];
    for out in &mut out {
        out.fill(0.0);
    }
    for (estimates, place) in sources {
        for (&start, row) in starts.iter().zip(estimates.chunks_exact(numbers)) {
            let held = start.max(range.start)..(start + LENGTH).min(range.end);
            if held.is_empty() {
                continue;
            }
            let within = held.start - range.start..held.end - range.start;
            for (out, coefficients) in out.iter_mut().zip(row[place.clone()].chunks_exact(COEFFICIENTS)) {
                let mut patch = [0.0; LENGTH];
                cosines.add_patch(coefficients, &mut patch);
                for (sum, x) in out[within.clone()].iter_mut().zip(&patch[held.start - start..]) {
                    *sum += x;
                }
            }
            for count in &mut counts[within] {
                *count += 1.0;
            }
        }
    }
    for out in out {
        for (sum, count) in out.iter_mut().zip(&counts) {
            *sum /= count;
        }
    }
}
