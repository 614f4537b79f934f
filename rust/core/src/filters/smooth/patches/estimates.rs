//! The patches of a task, and the averages of a pass.

use super::super::about::{About, Noisy};
use super::super::sums::{Joint, Sums};
use super::cosines::Cosines;
use super::groups::groups;
use super::nearest::{self, Nearest};
use super::wiener::{LANES, Model, width};
use super::{APART, COEFFICIENTS, LENGTH, NANOSECONDS, NEAR, RADIUS, STEP};
use crate::clip::Planes;
use crate::parallel::{self, Interrupt};
use crate::{Error, Real};
use std::ops::Range;
use std::sync::Mutex;

/// Models of a task.
const TASK: usize = 32;

/// Models of a pass.
const PASS: usize = 8 * TASK;

/// What all tasks of a pass share.
struct Pass<'a> {
    /// Vectors of all joints, from the frame `first` on.
    about: &'a [About],
    first: usize,
    cosines: &'a Cosines,
    /// How many patches the clip has.
    patches: usize,
}

/// Memory that goes from task to task.
#[derive(Default)]
struct Buffers {
    columns: Vec<f64>,
    /// A plane for each number of the pilot's patches.
    pilot: Planes<f64>,
    /// The same, a row for each patch.
    rows: Planes<f64>,
    /// A plane for each number of the patches of the rest, of those that are estimated.
    rest: Planes<f64>,
    nearest: Nearest,
    model: Option<Model>,
}

/// What a task says about the frames from `first` on.
struct Said {
    first: usize,
    frames: usize,
    /// Sums of the numbers of each column of the group, and of the weights.
    planes: Planes<f64>,
}

/// Makes one step: moves the pilot to the mean of what all estimated patches say.
pub(super) fn improve<T: Real>(
    noisy: &Noisy<'_, T>,
    out: &mut [T],
    interrupt: &Interrupt,
) -> Result<(), Error> {
    let frames = noisy.clip.frames();
    let joints = noisy.joints(super::LEAST_NOISE);
    let groups = counted(&groups(noisy, &joints, interrupt)?);
    let cosines = Cosines::new();
    let last = frames - LENGTH;
    let centres: Vec<usize> = (0..last).step_by(STEP).chain([last]).collect();
    // For each joint, the groups that it is in, as which of their members, and how often.
    let mut places = vec![Vec::new(); joints.len()];
    for (group, (members, times)) in groups.iter().enumerate() {
        for (member, &joint) in members.iter().enumerate() {
            places[joint].push((group, member, *times));
        }
    }
    let kept: Mutex<Vec<Buffers>> = Mutex::default();
    let mut about = Vec::new();
    let mut sums = Sums::new(joints.len());
    for (pass, own) in centres.chunks(PASS).enumerate() {
        let first = own[0].saturating_sub(RADIUS);
        let end = frames.min(own[own.len() - 1] + RADIUS + LENGTH);
        noisy.vectors(&joints, first..end, &mut about, interrupt)?;
        let pass_of = Pass { about: &about, first, cosines: &cosines, patches: last + 1 };
        let tasks: Vec<(&[usize], &[usize])> = groups
            .iter()
            .flat_map(|(members, _)| own.chunks(TASK).map(move |centres| (&members[..], centres)))
            .collect();
        let said = parallel::map(tasks, own.len() * groups.len() * NANOSECONDS, |_, (members, centres)| {
            interrupt.check()?;
            let mut buffers = kept.lock().map_or(None, |mut kept| kept.pop()).unwrap_or_default();
            let said = estimate(&pass_of, members, centres, &mut buffers);
            if let Ok(mut kept) = kept.lock() {
                kept.push(buffers);
            }
            Ok(said)
        })?;
        let tasks = own.len().div_ceil(TASK);
        let reach = frames.min(own[own.len() - 1] + NEAR + LENGTH);
        sums.add(reach, (reach - own[0]) * groups.len() * 20, |joint, from, sums| {
            for &(group, member, times) in &places[joint] {
                for said in &said[group * tasks..(group + 1) * tasks] {
                    add(said, member, times, from, sums);
                }
            }
        })?;
        // No later patch holds the frames before those near the next model begin.
        let settled = centres.get((pass + 1) * PASS).map_or(frames, |next| next - NEAR);
        sums.settle(noisy, &joints, settled, 1.0, out)?;
    }
    noisy.sign(out)
}

/// Groups, each once, and how often they are there: two joints that are most alike are two groups of the same members.
fn counted(groups: &[Vec<usize>]) -> Vec<(Vec<usize>, f64)> {
    let again =
        |joint: usize| groups[joint].iter().any(|&other| other != joint && groups[other].contains(&joint));
    let counted = |(joint, members): (usize, &Vec<usize>)| {
        let twice = again(joint);
        let first = members.iter().all(|&other| other >= joint);
        (!twice || first).then(|| (members.clone(), if twice { 2.0 } else { 1.0 }))
    };
    groups.iter().enumerate().filter_map(counted).collect()
}

/// Adds what a task says about one member of its group, as often as the group is there, to the sums of that joint, which begin at the
/// frame `from`.
fn add(said: &Said, member: usize, times: f64, from: usize, sums: &mut Joint) {
    let planes = said.planes.rows_from::<3>(member * 3);
    let weights = said.planes.row(said.planes.rows() - 1);
    for (sum, plane) in sums.iter_mut().zip(planes.into_iter().chain([weights])) {
        for (sum, x) in sum[said.first - from..].iter_mut().zip(&plane[..said.frames]) {
            *sum += times * x;
        }
    }
}

/// Estimates the patches of a group that are near `centres`.
fn estimate(
    pass: &Pass<'_>,
    members: &[usize],
    centres: &[usize],
    Buffers { columns, pilot, rows, rest, nearest, model }: &mut Buffers,
) -> Said {
    let (earliest, latest) = (centres[0], centres[centres.len() - 1]);
    let first = earliest.saturating_sub(RADIUS);
    let end = (latest + RADIUS + 1).min(pass.patches);
    let near = |centre: usize| {
        let before = NEAR.min(centre) / APART * APART;
        let after = NEAR.min(pass.patches - 1 - centre) / APART * APART;
        centre - before..centre + after + 1
    };
    let estimated = near(earliest).start..near(latest).end;
    let about = || members.iter().map(|&joint| &pass.about[joint]);
    pass.patches_of(about().flat_map(About::mean), first..end, columns, pilot);
    pass.patches_of(about().flat_map(About::beside), estimated.clone(), columns, rest);
    let numbers = pilot.rows();
    let width = width(numbers);
    rows.reshape(1, (end - first) * width);
    transpose(pilot, width, rows.row_mut(0));
    let model = model.get_or_insert_with(|| Model::new(numbers));
    let frames = estimated.len() + LENGTH - 1;
    let mut planes = Planes::new(members.len() * 3 + 1, frames);
    for &centre in centres {
        let window = centre.saturating_sub(RADIUS)..(centre + RADIUS + 1).min(pass.patches);
        let alike = nearest.find(pilot, centre - first, window.start - first, window.end - first);
        model.learn(rows.row(0), alike);
        let near = near(centre);
        let mut counts = [0.0; LANES];
        for start in alike.iter().map(|patch| first + patch).filter(|start| near.contains(start)) {
            if (start - near.start).is_multiple_of(APART) {
                counts[(start - near.start) / APART] = 1.0;
            }
        }
        let at = near.start - estimated.start;
        let moves = model.estimate((pilot, near.start - first), (rest, at), &counts);
        let used = near.len().div_ceil(APART);
        for (c, moves) in moves.chunks_exact(COEFFICIENTS).enumerate() {
            pass.cosines.add_patches(moves, used, &mut planes.row_mut(c)[at..]);
        }
        let weights = planes.row_mut(members.len() * 3);
        for (lane, &count) in counts[..used].iter().enumerate() {
            for weight in &mut weights[at + lane * APART..][..LENGTH] {
                *weight += count;
            }
        }
    }
    Said { first: estimated.start, frames, planes }
}

impl Pass<'_> {
    /// Writes the coefficients of the patches that begin in `starts`, a plane for each; the planes go on beyond them.
    fn patches_of<'a>(
        &self,
        vectors: impl Iterator<Item = &'a [f64]> + Clone,
        starts: Range<usize>,
        columns: &mut Vec<f64>,
        planes: &mut Planes<f64>,
    ) {
        let count = vectors.clone().count();
        let spare = nearest::BLOCK.max(APART * LANES).next_multiple_of(nearest::BLOCK);
        planes.reshape(count * COEFFICIENTS, starts.len().next_multiple_of(nearest::BLOCK) + spare);
        columns.resize(planes.length() + LENGTH - 1, 0.0);
        for (i, vectors) in vectors.enumerate() {
            let column = &vectors[starts.start - self.first..starts.end + LENGTH - 1 - self.first];
            columns[..column.len()].copy_from_slice(column);
            columns[column.len()..].fill(0.0);
            self.cosines.of_all(columns, planes.rows_mut::<COEFFICIENTS>(i * COEFFICIENTS));
        }
    }
}

/// From planes to rows of `width` numbers; those beyond the planes are 0.
fn transpose(planes: &Planes<f64>, width: usize, rows: &mut [f64]) {
    /// Rows that are written together: they stay in the first-level cache.
    const ROWS: usize = 16;
    rows.chunks_mut(ROWS * width).enumerate().for_each(|(chunk, rows)| {
        for number in 0..width {
            let column = rows[number..].iter_mut().step_by(width);
            if number < planes.rows() {
                for (x, from) in column.zip(&planes.row(number)[chunk * ROWS..]) {
                    *x = *from;
                }
            } else {
                column.for_each(|x| *x = 0.0);
            }
        }
    });
}
