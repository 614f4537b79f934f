//! Displacements of feet: from paths, contacts and targets, blended over time.

use super::paths::{complete, estimate};
use super::{Point, add, contacts, is_known, norm, runs, scaled, subtract, targets};
use crate::error::check_length;
use crate::filters::smooth::PathSmoother;
use crate::parallel::{self, Interrupt};
use crate::{Error, Real};

/// Leg length for which the thresholds hold, centimetres: lengths are multiplied by 90 / leg length.
const LEG: f64 = 90.0;

/// Largest displacement of a foot, centimetres.
const FARTHEST: f64 = 3.0;

/// Fade time of a displacement before and after its contact, seconds.
const FADE: f64 = 0.1;

/// Longest gap between contacts, in seconds, across which displacements are interpolated.
const BRIDGE: f64 = 0.2;

/// Joints of a foot: ankle and toe.
const PARTS: usize = 2;

/// Estimated nanoseconds per frame of a foot joint.
const NANOSECONDS: usize = 3000;

/// Feet before and after a filter.
#[derive(Debug, Clone, Copy)]
pub struct FootPaths<'a, T> {
    /// Paths of ankle and toe of each leg in the input, `(frames, legs, 2, 3)`. A leg without a toe repeats its
    /// ankle.
    pub before: &'a [T],
    /// The same in the filtered motion.
    pub after: &'a [T],
    /// Lengths of the legs in the unit of the paths.
    pub lengths: &'a [f64],
    /// The vertical axis.
    pub up: usize,
    /// Whether it points down.
    pub down: bool,
    /// Frames per second.
    pub fps: f64,
    /// Given contacts, `(frames, legs, 2)`.
    pub contacts: Option<&'a [bool]>,
    /// Whether feet are locked to one point; otherwise they follow their path in the input.
    pub lock: bool,
}

/// Output of [`foot_displacements`].
#[derive(Debug)]
pub struct Displacements<'a> {
    /// `(frames, legs, 2, 3)`, in the unit of the paths.
    pub displacements: &'a mut [f64],
    /// `(frames, legs, 2)`.
    pub contacts: &'a mut [bool],
}

impl<T: Real> FootPaths<'_, T> {
    /// Estimated nanoseconds of [`foot_displacements`].
    #[must_use]
    pub fn nanoseconds(&self) -> usize {
        self.before.len() / 3 * NANOSECONDS
    }

    fn path(&self, values: &[T], column: usize, scale: f64) -> Vec<Point> {
        let joints = self.lengths.len() * PARTS;
        let rows = values.chunks_exact(joints * 3);
        rows.map(|row| std::array::from_fn(|c| row[column * 3 + c].to_f64() * scale)).collect()
    }
}

/// A joint's displacements, their weights and its contacts.
struct Moved {
    displacements: Vec<Point>,
    weights: Vec<f64>,
    contacts: Vec<bool>,
}

/// Finds ground contacts, and the displacements of the feet.
///
/// # Errors
/// [`Error::Length`] if the lengths of slices do not agree; [`Error::Parameter`] if `up` is not an axis;
/// [`Error::Interrupted`].
pub fn foot_displacements<T: Real>(
    paths: FootPaths<'_, T>,
    out: Displacements<'_>,
    interrupt: &Interrupt,
) -> Result<(), Error> {
    let Displacements { displacements, contacts: standing } = out;
    let joints = paths.lengths.len() * PARTS;
    let frames = paths.before.len() / (joints * 3).max(1);
    check_length("before", frames * joints * 3, paths.before.len())?;
    check_length("after", paths.before.len(), paths.after.len())?;
    check_length("displacements", paths.before.len(), displacements.len())?;
    check_length("contacts", frames * joints, standing.len())?;
    if let Some(contacts) = paths.contacts {
        check_length("contacts", frames * joints, contacts.len())?;
    }
    if paths.up > 2 {
        return Err(Error::Parameter { name: "up", expected: "an axis, 0 to 2" });
    }
    displacements.fill(0.0);
    standing.fill(false);
    if frames < 2 {
        return Ok(());
    }
    let smoother = PathSmoother::new(frames);
    let work = |_, column| one_joint(&paths, column, &smoother, interrupt);
    let moved = parallel::map((0..joints).collect(), paths.nanoseconds(), work)?;
    for (leg, pair) in moved.chunks_exact(PARTS).enumerate() {
        let scale = LEG / paths.lengths[leg];
        let [ankle, toe] = pair else { continue };
        for t in 0..frames {
            let [a, b] = both(ankle, toe, t, paths.lock);
            let at = t * joints + leg * PARTS;
            for (part, point) in [a, b].into_iter().enumerate() {
                let to = &mut displacements[(at + part) * 3..(at + part + 1) * 3];
                to.copy_from_slice(&point.map(|x| x / scale));
            }
            standing[at] = ankle.contacts[t];
            standing[at + 1] = toe.contacts[t];
        }
    }
    Ok(())
}

/// Displacements of ankle and toe in one frame: each has its own if it is in contact, or that of the other if only
/// that one is.
fn both(ankle: &Moved, toe: &Moved, t: usize, lock: bool) -> [Point; 2] {
    let (w_a, w_t) = (ankle.weights[t], toe.weights[t]);
    let (d_a, d_t) = (scaled(ankle.displacements[t], w_a), scaled(toe.displacements[t], w_t));
    let a = add(d_a, scaled(d_t, 1.0 - w_a));
    let b = add(d_t, scaled(d_a, 1.0 - w_t));
    if lock {
        return [a, b];
    }
    // The foot is rotated by half of the rotation that its two ends would require.
    let quarter = |near: Point, far: Point| std::array::from_fn(|c| (3.0 * near[c] + far[c]) / 4.0);
    [quarter(a, b), quarter(b, a)]
}

fn one_joint<T: Real>(
    paths: &FootPaths<'_, T>,
    column: usize,
    smoother: &PathSmoother,
    interrupt: &Interrupt,
) -> Result<Moved, Error> {
    let scale = LEG / paths.lengths[column / PARTS];
    let mut f = paths.path(paths.after, column, scale);
    let frames = f.len();
    let known: Vec<bool> = f.iter().map(|&point| is_known(point)).collect();
    if !known.contains(&true) {
        return Ok(Moved {
            displacements: vec![[0.0; 3]; frames],
            weights: vec![0.0; frames],
            contacts: known,
        });
    }
    complete(&mut f);
    let mut x = paths.path(paths.before, column, scale);
    for (x, f) in x.iter_mut().zip(&f) {
        if !is_known(*x) {
            *x = *f;
        }
    }
    let (y, noise) = estimate(&x, &f, smoother, interrupt)?;
    let joints = paths.lengths.len() * PARTS;
    let touching: Vec<bool> = match paths.contacts {
        Some(given) => {
            known.iter().zip(given.chunks_exact(joints)).map(|(&known, row)| known && row[column]).collect()
        }
        None => contacts::find(&y, &known, noise, (paths.up, paths.down), paths.fps, interrupt)?,
    };
    let mut target = f.clone();
    let mut held = touching.clone();
    for contact in runs(&touching) {
        let smoothed = targets::smoothed(&y[contact.clone()], noise, paths.fps, interrupt)?;
        target[contact.clone()].copy_from_slice(&smoothed);
        if paths.lock {
            targets::hold(&y, &mut target, &mut held, contact, noise, paths.up, paths.fps);
        }
    }
    let away: Vec<Point> = (0..frames)
        .map(|t| {
            let away = subtract(target[t], f[t]);
            let length = norm(away);
            if !held[t] {
                [0.0; 3]
            } else if length > FARTHEST {
                scaled(away, FARTHEST / length)
            } else {
                away
            }
        })
        .collect();
    let (displacements, weights) = blended(&away, &held, paths.fps);
    Ok(Moved { displacements, weights, contacts: held })
}

/// Extrapolates displacements past their contacts, with weights that fade out; between contacts close to each other
/// they are interpolated.
fn blended(away: &[Point], held: &[bool], fps: f64) -> (Vec<Point>, Vec<f64>) {
    let frames = held.len();
    let mut moved = away.to_vec();
    let mut weights: Vec<f64> = held.iter().map(|&held| f64::from(u8::from(held))).collect();
    let fade = FADE * fps;
    let weight = |u: f64| 1.0 - 3.0 * u * u + 2.0 * (u * u * u);
    let free: Vec<bool> = held.iter().map(|held| !held).collect();
    for run in runs(&free) {
        let before = run.start.checked_sub(1).map(|t| away[t]);
        let after = away.get(run.end).copied();
        if let Some((from, to)) = before.zip(after)
            && run.len() as f64 <= BRIDGE * fps
        {
            for t in run.clone() {
                let u = (t - run.start + 1) as f64 / (run.len() + 1) as f64;
                moved[t] = add(scaled(from, 1.0 - u), scaled(to, u));
                weights[t] = 1.0;
            }
            continue;
        }
        for t in run.clone() {
            let since = (t - run.start + 1) as f64 / fade;
            let until = (run.end - t) as f64 / fade;
            if let Some(from) = before
                && since < 1.0
            {
                moved[t] = from;
                weights[t] = weight(since);
            }
            if let Some(to) = after
                && until < 1.0
            {
                moved[t] = to;
                weights[t] = weight(until);
            }
        }
    }
    debug_assert_eq!(moved.len(), frames);
    (moved, weights)
}
