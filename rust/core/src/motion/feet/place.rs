//! Inverse kinematics of the legs: damped least squares on the pelvis, the hips and the knees of each frame.
//!
//! S. R. Buss, *Introduction to Inverse Kinematics with Jacobian Transpose, Pseudoinverse and Damped Least Squares Methods*, 2004.

use super::chain::{Chain, Joints, Places, Pose};
use super::{Point, add, cross, inner, is_known, norm, scaled, subtract};
use crate::eigen::eigenvectors;
use crate::error::check_length;
use crate::parallel::{self, Interrupt};
use crate::rotations::quaternion::{between, conjugate_one, exp_one, log_short, product, rotate, unit};
use crate::{ClipView, Error, Real};

/// Number of times that the linear equations are set up and solved.
const STEPS: usize = 3;

/// Damping `λ`, in leg lengths: with the pelvis, and with the legs only.
const DAMPING: f64 = 0.2;
const DAMPING_OF_LEGS: f64 = 0.3;

/// Column scales of the parameters; the hips have 1.
const ROOT_TRANSLATION: f64 = 0.3;
const ROOT_ROTATION: f64 = 0.5;
const KNEE: f64 = 0.5;

/// Fraction of an ankle's rotation that is applied if feet follow their path.
const ANKLE: f64 = 0.5;

/// Largest rotation of an ankle, radians, if feet follow their path.
const MOST_ANKLE: f64 = 3.0 * std::f64::consts::PI / 180.0;

/// Sum of squares of a knee's rotation increments, in rad², below which it has no axis.
const LEAST_HINGE: f64 = 1e-12;

/// Largest number of legs: each adds three equations.
const MOST_LEGS: usize = 2;

/// Largest number of equations.
const ROWS: usize = 3 * MOST_LEGS;

/// Frames per task.
const TILE: usize = 128;

/// Estimated nanoseconds per frame.
const NANOSECONDS: usize = 3000;

/// Product of two lengths below which directions count as opposite.
const OPPOSITE: f64 = 1e-9;

/// A body whose feet are moved.
#[derive(Debug, Clone, Copy)]
pub struct Body<'a, T> {
    /// Rotations relative to the parents.
    pub rotations: ClipView<'a, T>,
    /// Positions of joint 0, `(frames, 3)`.
    pub translation: &'a [T],
    /// Positions of the joints in their parents' frames, `(1 or frames, joints, 3)`.
    pub local: &'a [T],
    /// The parent of each joint, `None` for a root.
    pub parents: &'a [Option<usize>],
    /// The joint above all legs; joint 0 or below it.
    pub pelvis: usize,
    /// Hip, knee, ankle and toe of each leg; the toe is the ankle if there is none.
    pub legs: &'a [[usize; 4]],
    /// Lengths of the legs.
    pub lengths: &'a [f64],
    /// Displacements of ankle and toe, `(frames, legs, 2, 3)`.
    pub displacements: &'a [f64],
    /// Whether the body and the pelvis may move; otherwise only the legs do.
    pub root: bool,
    /// Whether ankles are rotated fully.
    pub lock: bool,
}

/// Output of [`place_feet`].
#[derive(Debug)]
pub struct Placed<'a, T> {
    /// `(frames, joints, 4)`.
    pub rotations: &'a mut [T],
    /// `(frames, 3)`.
    pub translation: &'a mut [T],
}

impl<T: Real> Body<'_, T> {
    /// Estimated nanoseconds of [`place_feet`].
    #[must_use]
    pub fn nanoseconds(&self) -> usize {
        self.rotations.frames() * NANOSECONDS
    }

    fn check(&self, out: &Placed<'_, T>) -> Result<(), Error> {
        let (frames, joints) = (self.rotations.frames(), self.rotations.joints());
        let row = joints * 3;
        check_length("translation", frames * 3, self.translation.len())?;
        check_length("parents", joints, self.parents.len())?;
        if self.local.len() != row {
            check_length("local", frames * row, self.local.len())?;
        }
        check_length("lengths", self.legs.len(), self.lengths.len())?;
        check_length("displacements", frames * self.legs.len() * 6, self.displacements.len())?;
        check_length("out", frames * joints * 4, out.rotations.len())?;
        check_length("translation out", frames * 3, out.translation.len())?;
        if self.parents.iter().enumerate().any(|(joint, parent)| parent.is_some_and(|parent| parent >= joint))
        {
            return Err(Error::Parameter {
                name: "parents",
                expected: "parents that precede their children",
            });
        }
        if self.legs.is_empty() || self.legs.len() > MOST_LEGS {
            return Err(Error::Parameter { name: "legs", expected: "one leg or two" });
        }
        let above = |joint: usize, ancestor: usize| {
            let mut parent = self.parents[joint];
            while let Some(here) = parent.filter(|&here| here != ancestor) {
                parent = self.parents[here];
            }
            parent == Some(ancestor)
        };
        let chained = |&[hip, knee, ankle, toe]: &[usize; 4]| {
            [hip, knee, ankle, toe].iter().all(|&joint| joint < joints)
                && above(hip, self.pelvis)
                && above(knee, hip)
                && above(ankle, knee)
                && (toe == ankle || above(toe, ankle))
        };
        let rooted = self.pelvis == 0 || (self.pelvis < joints && above(self.pelvis, 0));
        if joints == 0 || !rooted || !self.legs.iter().all(chained) {
            return Err(Error::Parameter { name: "legs", expected: "joints that hang on each other" });
        }
        Ok(())
    }

    fn pose(&self, frame: usize) -> Pose<'_, T> {
        let joints = self.rotations.joints();
        let row = joints * 3;
        let start = if self.local.len() == row { 0 } else { frame * row };
        Pose {
            parents: self.parents,
            rotations: self.rotations.slice(frame, frame + 1).data(),
            local: &self.local[start..start + row],
        }
    }

    /// Displacements of ankle and toe of a leg.
    fn wanted(&self, frame: usize, leg: usize) -> [Point; 2] {
        let at = (frame * self.legs.len() + leg) * 6;
        [0, 3].map(|part| std::array::from_fn(|c| self.displacements[at + part + c]))
    }
}

/// Moves feet by rotations of hips, knees and ankles, and by the pelvis.
///
/// Let `d` be the remaining displacements of the ankles in leg lengths. Each of three steps solves `θ = C Jᵀ (J Jᵀ +
/// λ² I)⁻¹ d`, with `J` the derivative of the ankles with respect to the parameters times the column scales `C`. The
/// equations contain all ankles; those that do not move have `d = 0`. Then each ankle is rotated by a fraction of the
/// rotation that takes the line from ankle to toe to its target. A frame without displacements is unchanged.
///
/// # Errors
/// [`Error::Length`] if the lengths of slices do not agree; [`Error::Parameter`] if the legs are invalid;
/// [`Error::Interrupted`].
pub fn place_feet<T: Real>(
    body: Body<'_, T>,
    out: Placed<'_, T>,
    interrupt: &Interrupt,
) -> Result<(), Error> {
    body.check(&out)?;
    let Placed { rotations, translation } = out;
    rotations.copy_from_slice(body.rotations.data());
    translation.copy_from_slice(body.translation);
    let joints = body.rotations.joints();
    let hinges =
        parallel::map((0..body.legs.len()).collect(), body.rotations.frames() * 60, |_, leg: usize| {
            hinge(body.rotations, body.legs[leg][1], interrupt)
        })?;
    let rotations = rotations.chunks_mut(TILE * joints * 4);
    let tiles: Vec<(&mut [T], &mut [T])> = rotations.zip(translation.chunks_mut(TILE * 3)).collect();
    parallel::for_each(tiles, body.nanoseconds(), |tile, (rotations, translation)| {
        interrupt.check()?;
        let rows = rotations.chunks_exact_mut(joints * 4).zip(translation.chunks_exact_mut(3));
        for (i, (rotations, translation)) in rows.enumerate() {
            one_frame(&body, tile * TILE + i, &hinges, rotations, translation);
        }
        Ok(())
    })
}

fn one_frame<T: Real>(
    body: &Body<'_, T>,
    frame: usize,
    hinges: &[Point],
    rotations: &mut [T],
    translation: &mut [T],
) {
    let count = body.legs.len();
    let at = frame * count * 6;
    if body.displacements[at..at + count * 6].iter().all(|&x| x == 0.0) {
        return;
    }
    let pose = body.pose(frame);
    let mut above = [1.0, 0.0, 0.0, 0.0];
    let mut position: Point = std::array::from_fn(|c| translation[c].to_f64());
    if body.pelvis != 0 {
        let (rotation, offset) = pose.between(0, body.pelvis);
        position = add(position, rotate(pose.rotation(0), offset));
        above = product(pose.rotation(0), rotation);
    }
    let before = product(above, pose.rotation(body.pelvis));
    if !(before.iter().all(|x| x.is_finite()) && is_known(position)) {
        return;
    }
    let mut legs = [None; MOST_LEGS];
    for (i, (leg, hinge)) in body.legs.iter().zip(hinges).enumerate() {
        let &[hip, knee, ankle, toe] = leg;
        let chain = Chain::of(pose, body.pelvis, Joints { hip, knee, ankle, toe }, *hinge);
        legs[i] = chain.is_known().then_some(Leg { old: chain, new: chain, wanted: body.wanted(frame, i) });
    }
    if legs.iter().all(Option::is_none) {
        return;
    }
    let length = body.lengths.iter().sum::<f64>() / body.lengths.len() as f64;
    let (turned, shifted) = solve(&mut legs, length, before, position, body.root);
    for (leg, joints) in legs.iter().zip(body.legs) {
        let Some(leg) = leg else { continue };
        let ankle = turned_ankle(leg, before, turned, body.lock);
        for (&joint, q) in joints.iter().zip([leg.new.hip, leg.new.knee, ankle]) {
            write(q, &mut rotations[joint * 4..joint * 4 + 4]);
        }
    }
    if body.root {
        write(product(conjugate_one(above), turned), &mut rotations[body.pelvis * 4..body.pelvis * 4 + 4]);
        for (c, value) in translation.iter_mut().enumerate() {
            *value += T::from_f64(shifted[c] - position[c]);
        }
    }
}

fn write<T: Real>(q: [f64; 4], out: &mut [T]) {
    for (to, from) in out.iter_mut().zip(q) {
        *to = T::from_f64(from);
    }
}

/// A leg in the equations.
#[derive(Debug, Clone, Copy)]
struct Leg {
    old: Chain,
    new: Chain,
    /// Displacements of ankle and toe.
    wanted: [Point; 2],
}

/// Derivatives of an ankle in one step, lengths in leg lengths.
#[derive(Debug, Clone, Copy, Default)]
struct Row {
    known: bool,
    from_root: Point,
    from_hip: Point,
    /// With respect to the angle of the knee.
    from_knee: Point,
    error: Point,
}

/// Solves for the pelvis, the hips and the knees; returns orientation and position of the pelvis.
fn solve(
    legs: &mut [Option<Leg>; MOST_LEGS],
    length: f64,
    mut turned: [f64; 4],
    mut shifted: Point,
    root: bool,
) -> ([f64; 4], Point) {
    let goals = legs.map(|leg| leg.map(|leg| add(leg.new.places(turned, shifted).ankle, leg.wanted[0])));
    let damping = if root { DAMPING } else { DAMPING_OF_LEGS };
    let (by_root, by_turn) =
        if root { (ROOT_TRANSLATION * ROOT_TRANSLATION, ROOT_ROTATION * ROOT_ROTATION) } else { (0.0, 0.0) };
    for _ in 0..STEPS {
        let mut rows = [Row::default(); MOST_LEGS];
        let mut places = [None; MOST_LEGS];
        for ((row, place), (leg, goal)) in rows.iter_mut().zip(&mut places).zip(legs.iter().zip(goals)) {
            if let Some((leg, goal)) = leg.as_ref().zip(goal) {
                let here = leg.new.places(turned, shifted);
                *row = derivatives(&leg.new, &here, shifted, goal, length);
                *place = Some(here);
            }
        }
        let force = forces(&rows, by_root, by_turn, damping * damping);
        let (mut torque, mut pull) = ([0.0; 3], [0.0; 3]);
        for (i, (leg, place)) in legs.iter_mut().zip(&places).enumerate() {
            let Some((leg, place)) = leg.as_mut().zip(*place) else { continue };
            let by_hip = rotate(conjugate_one(place.thigh), cross(rows[i].from_hip, force[i]));
            leg.new.hip = unit(product(leg.new.hip, exp_one(scaled(by_hip, 0.5))));
            let angle = KNEE * KNEE * inner(rows[i].from_knee, force[i]);
            leg.new.knee = unit(product(leg.new.knee, exp_one(scaled(leg.new.hinge, 0.5 * angle))));
            torque = add(torque, cross(rows[i].from_root, force[i]));
            pull = add(pull, force[i]);
        }
        if root {
            shifted = add(shifted, scaled(pull, by_root * length));
            let turn = rotate(conjugate_one(turned), scaled(torque, by_turn));
            turned = unit(product(turned, exp_one(scaled(turn, 0.5))));
        }
    }
    (turned, shifted)
}

fn derivatives(leg: &Chain, place: &Places, pelvis: Point, goal: Point, length: f64) -> Row {
    let over = |a: Point, b: Point| subtract(a, b).map(|x| x / length);
    Row {
        known: true,
        from_root: over(place.ankle, pelvis),
        from_hip: over(place.ankle, place.hip),
        from_knee: cross(rotate(place.shank, leg.hinge), over(place.ankle, place.knee)),
        error: over(goal, place.ankle),
    }
}

/// Solves `(J Jᵀ + λ² I) f = d`.
fn forces(rows: &[Row; MOST_LEGS], by_root: f64, by_turn: f64, damping: f64) -> [Point; MOST_LEGS] {
    let mut matrix = [[0.0; ROWS]; ROWS];
    for (i, one) in rows.iter().enumerate() {
        for (j, other) in rows.iter().enumerate() {
            let both = if one.known && other.known { by_root } else { 0.0 };
            let turn = crossed(one.from_root, other.from_root);
            for a in 0..3 {
                for b in 0..3 {
                    matrix[3 * i + a][3 * j + b] = by_turn * turn[a][b] + if a == b { both } else { 0.0 };
                }
            }
        }
        let hip = crossed(one.from_hip, one.from_hip);
        for a in 0..3 {
            for b in 0..3 {
                let own = hip[a][b] + KNEE * KNEE * one.from_knee[a] * one.from_knee[b];
                matrix[3 * i + a][3 * i + b] += own + if a == b { damping } else { 0.0 };
            }
        }
    }
    let mut right = [0.0; ROWS];
    right.copy_from_slice(rows.map(|row| row.error).as_flattened());
    cholesky(&mut matrix, &mut right);
    std::array::from_fn(|i| std::array::from_fn(|c| right[3 * i + c]))
}

/// `[r]ₓ [s]ₓᵀ = (r·s) I − s rᵀ`.
fn crossed(r: Point, s: Point) -> [Point; 3] {
    let dot = inner(r, s);
    std::array::from_fn(|a| std::array::from_fn(|b| if a == b { dot } else { 0.0 } - s[a] * r[b]))
}

/// Solves `M x = b` for a symmetric positive matrix; `b` becomes `x`.
fn cholesky(matrix: &mut [[f64; ROWS]; ROWS], right: &mut [f64; ROWS]) {
    for i in 0..ROWS {
        for j in 0..=i {
            let before: f64 = matrix[i][..j].iter().zip(&matrix[j][..j]).map(|(a, b)| a * b).sum();
            let rest = matrix[i][j] - before;
            matrix[i][j] = if i == j { rest.sqrt() } else { rest / matrix[j][j] };
        }
    }
    for i in 0..ROWS {
        for k in 0..i {
            right[i] -= matrix[i][k] * right[k];
        }
        right[i] /= matrix[i][i];
    }
    for i in (0..ROWS).rev() {
        for k in i + 1..ROWS {
            right[i] -= matrix[k][i] * right[k];
        }
        right[i] /= matrix[i][i];
    }
}

/// The ankle's rotation in the shank that takes the foot to its goal. If feet follow their path: half of that
/// rotation, and at most [`MOST_ANKLE`].
fn turned_ankle(leg: &Leg, before: [f64; 4], turned: [f64; 4], lock: bool) -> [f64; 4] {
    let origin = [0.0; 3];
    let old = product(leg.old.places(before, origin).shank, leg.old.to_ankle);
    let new = product(leg.new.places(turned, origin).shank, leg.new.to_ankle);
    let foot = product(old, leg.old.ankle);
    let sole = rotate(foot, leg.old.toe_at);
    let [ankle, toe] = leg.wanted;
    let goal = product(least_rotation(sole, add(sole, subtract(toe, ankle))), foot);
    let change = log_short(between(leg.old.ankle, between(new, goal)));
    let part = if lock {
        1.0
    } else {
        let angle = 2.0 * ANKLE * norm(change);
        if angle > MOST_ANKLE { ANKLE * (MOST_ANKLE / angle) } else { ANKLE }
    };
    unit(product(leg.old.ankle, exp_one(scaled(change, part))))
}

/// The smallest rotation from one direction to another; the identity if a vector has length 0.
fn least_rotation(u: Point, v: Point) -> [f64; 4] {
    let lengths = norm(u) * norm(v);
    let axis = cross(u, v);
    let q = [lengths + inner(u, v), axis[0], axis[1], axis[2]];
    let size = (q[0] * q[0] + inner(axis, axis)).sqrt();
    if lengths == 0.0 || size <= OPPOSITE * lengths { [1.0, 0.0, 0.0, 0.0] } else { unit(q) }
}

/// The axis of a knee: the main axis of its rotation increments in the shank frame; zeros if it does not move.
fn hinge<T: Real>(clip: ClipView<'_, T>, knee: usize, interrupt: &Interrupt) -> Result<Point, Error> {
    let mut squares = [0.0; 9];
    let mut last = [f64::NAN; 4];
    for frame in 0..clip.frames() {
        if frame % (1 << 14) == 0 {
            interrupt.check()?;
        }
        let here = clip.at(frame, knee).map(T::to_f64);
        let step = scaled(log_short(between(last, here)), 2.0);
        last = here;
        if is_known(step) {
            for i in 0..3 {
                for j in 0..3 {
                    squares[3 * i + j] += step[i] * step[j];
                }
            }
        }
    }
    if squares[0] + squares[4] + squares[8] < LEAST_HINGE {
        return Ok([0.0; 3]);
    }
    let axes = eigenvectors(&mut squares, 3, interrupt)?;
    let largest =
        (0..3).fold(0, |best, axis| if squares[4 * axis] > squares[4 * best] { axis } else { best });
    Ok(std::array::from_fn(|i| axes[3 * i + largest]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cholesky_solves() {
        let entry = |i: usize, j: usize| if i == j { 5.0 } else { 1.0 / (1.0 + (i + j) as f64) };
        let matrix: [[f64; ROWS]; ROWS] = std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)));
        let right: [f64; ROWS] = std::array::from_fn(|i| i as f64 - 2.0);
        let mut x = right;
        cholesky(&mut matrix.clone(), &mut x);
        for i in 0..ROWS {
            let product: f64 = (0..ROWS).map(|j| matrix[i][j] * x[j]).sum();
            assert!((product - right[i]).abs() < 1e-12);
        }
    }

    #[test]
    fn the_least_rotation_brings_one_direction_to_the_other() {
        let (u, v) = ([0.0, 2.0, 0.0], [0.0, 0.0, 0.5]);
        let turned = rotate(least_rotation(u, v), u);
        assert!(norm(subtract(turned, [0.0, 0.0, 2.0])) < 1e-14);
        assert_eq!(least_rotation(u, [0.0; 3]), [1.0, 0.0, 0.0, 0.0]);
        assert_eq!(least_rotation(u, scaled(u, -1.0)), [1.0, 0.0, 0.0, 0.0]);
    }
}
