//! Forward kinematics of the control points and its Jacobian.
//!
//! The coordinates of a pose are a rotation vector for each joint and four numbers for the root's displacement. Joint
//! `j` has the rotation `c_j exp(x_j / 2)` with its centre `c_j`. The root is rotated in addition by its heading: the
//! previous heading plus a change. Its position is the previous position plus a step in the frame of the previous
//! heading; its height is absolute: `x = [3·J joint coordinates, forward, sideways, height, heading change]`.
//!
//! Joints without a control point below them do not affect the control points: only the chains above control points
//! are computed.

use super::frame::{rotated, rotation_about};
use crate::Error;
use crate::Real;
use crate::rotations::quaternion::{exp_one, of_row, product, rotate};

/// Number of coordinates of the root's displacement.
pub const ROOT: usize = 4;

/// Squared angle, radians², below which two terms of the series are accurate to float64 and `θ − sin θ` is not.
const SMALL_SQUARE: f64 = 1e-4;

/// A 3 × 3 matrix, row by row.
pub(super) type Matrix = [[f64; 3]; 3];

/// A skeleton with its control points.
#[derive(Debug, Clone)]
pub struct Body {
    /// The axis that points up.
    pub up: usize,
    joints: usize,
    /// The control points and the joints above them, parents first.
    active: Vec<Joint>,
    /// The index of each control point in `active`.
    points: Vec<usize>,
}

/// A control point or a joint above one.
#[derive(Debug, Clone, Copy)]
struct Joint {
    index: usize,
    /// Index of its parent among the active joints.
    parent: Option<usize>,
    offset: [f64; 3],
}

impl Body {
    /// A skeleton with one root, the first joint, and offsets `(joints, 3)`; `points` are the joints that are control
    /// points.
    ///
    /// # Errors
    /// [`Error::Length`] and [`Error::Parameter`] if these do not agree.
    pub fn new(
        parents: &[Option<usize>],
        offsets: &[f64],
        points: &[usize],
        up: usize,
    ) -> Result<Self, Error> {
        let joints = parents.len();
        crate::error::check_length("offsets", joints * 3, offsets.len())?;
        let follow = parents.iter().enumerate().all(|(j, parent)| parent.map_or(j == 0, |parent| parent < j));
        if joints == 0 || !follow {
            return Err(Error::Parameter { name: "parents", expected: "one root, before all other joints" });
        }
        if up > 2 || points.iter().any(|&point| point >= joints) {
            return Err(Error::Parameter { name: "points", expected: "joints, and an axis" });
        }
        let mut wanted = vec![false; joints];
        wanted[0] = true;
        for &point in points {
            let mut joint = Some(point);
            while let Some(j) = joint {
                wanted[j] = true;
                joint = parents[j];
            }
        }
        let mut slot = vec![0; joints];
        let mut active = Vec::new();
        for joint in (0..joints).filter(|&joint| wanted[joint]) {
            slot[joint] = active.len();
            let offset = [offsets[joint * 3], offsets[joint * 3 + 1], offsets[joint * 3 + 2]];
            active.push(Joint { index: joint, parent: parents[joint].map(|parent| slot[parent]), offset });
        }
        let points = points.iter().map(|&point| slot[point]).collect();
        Ok(Self { up, joints, active, points })
    }

    /// Number of joints of the skeleton.
    #[must_use]
    pub fn joints(&self) -> usize {
        self.joints
    }

    /// Number of control points.
    #[must_use]
    pub fn points(&self) -> usize {
        self.points.len()
    }

    /// Number of coordinates of a pose.
    #[must_use]
    pub fn coordinates(&self) -> usize {
        3 * self.joints + ROOT
    }

    /// The coordinates that move control points, in the order of the Jacobian's columns.
    #[must_use]
    pub fn columns(&self) -> Vec<usize> {
        let of_joints = self.active.iter().flat_map(|joint| (0..3).map(move |i| 3 * joint.index + i));
        of_joints.chain(3 * self.joints..self.coordinates()).collect()
    }
}

/// Origin of the coordinates.
#[derive(Debug, Clone)]
pub struct Base {
    /// Rotations of all joints at the origin, `(joints, 4)`; the root's without its heading.
    pub centres: Vec<f64>,
    /// Position of the root in the previous frame; its height is not used.
    pub place: [f64; 3],
    /// Heading of the root in the previous frame, radians.
    pub heading: f64,
}

impl Base {
    /// Rotation of a joint relative to its parent; the root's includes its heading.
    fn rotation(&self, joint: usize, x: &[f64], up: usize, joints: usize) -> [f64; 4] {
        let half = [0.5 * x[3 * joint], 0.5 * x[3 * joint + 1], 0.5 * x[3 * joint + 2]];
        let rotation = product(of_row(&self.centres[4 * joint..]), exp_one(half));
        if joint == 0 {
            product(rotation_about(self.heading + x[3 * joints + 3], up), rotation)
        } else {
            rotation
        }
    }

    fn position(&self, x: &[f64], up: usize, joints: usize) -> [f64; 3] {
        let step = rotated([x[3 * joints], x[3 * joints + 1]], self.heading, up);
        let mut position: [f64; 3] = std::array::from_fn(|i| self.place[i] + step[i]);
        position[up] = x[3 * joints + 2];
        position
    }

    /// Writes the rotations `(joints, 4)`, the root's including its heading, and returns the root's position.
    pub fn pose(&self, x: &[f64], up: usize, rotations: &mut [f64]) -> [f64; 3] {
        let joints = rotations.len() / 4;
        for (joint, out) in rotations.chunks_exact_mut(4).enumerate() {
            out.copy_from_slice(&self.rotation(joint, x, up, joints));
        }
        self.position(x, up, joints)
    }
}

/// Positions, rotations and Jacobians of the active joints of a pose.
#[derive(Debug, Clone)]
pub(super) struct Points {
    columns: usize,
    positions: Vec<[f64; 3]>,
    rotations: Vec<[f64; 4]>,
    jacobians: Vec<Matrix>,
}

impl Points {
    pub(super) fn new(body: &Body) -> Self {
        let count = body.active.len();
        Self {
            columns: 3 * count + ROOT,
            positions: vec![[0.0; 3]; count],
            rotations: vec![[0.0; 4]; count],
            jacobians: vec![[[0.0; 3]; 3]; count],
        }
    }

    /// Number of coordinates that move control points.
    pub(super) fn columns(&self) -> usize {
        self.columns
    }

    /// Computes the joints for the coordinates `x`.
    pub(super) fn place(&mut self, body: &Body, base: &Base, x: &[f64]) {
        for (i, joint) in body.active.iter().enumerate() {
            let local = base.rotation(joint.index, x, body.up, body.joints);
            if let Some(parent) = joint.parent {
                let bone = rotate(self.rotations[parent], joint.offset);
                self.positions[i] = std::array::from_fn(|c| self.positions[parent][c] + bone[c]);
                self.rotations[i] = product(self.rotations[parent], local);
            } else {
                self.positions[i] = base.position(x, body.up, body.joints);
                self.rotations[i] = local;
            }
            let own = [x[3 * joint.index], x[3 * joint.index + 1], x[3 * joint.index + 2]];
            self.jacobians[i] = times(&matrix(self.rotations[i]), &right_jacobian(own));
        }
    }

    /// Position and global rotation of a control point.
    pub(super) fn at(&self, body: &Body, point: usize) -> ([f64; 3], [f64; 4]) {
        let joint = body.points[point];
        (self.positions[joint], self.rotations[joint])
    }

    /// Rotation Jacobian of a control point: angular velocities in the world frame per coordinate, `(3, columns)`.
    pub(super) fn rotation_rows(&self, body: &Body, point: usize, rows: &mut [f64]) {
        rows.fill(0.0);
        let mut next = Some(body.points[point]);
        while let Some(joint) = next {
            for (row, jacobian) in rows.chunks_exact_mut(self.columns).zip(&self.jacobians[joint]) {
                row[3 * joint..3 * joint + 3].copy_from_slice(jacobian);
            }
            next = body.active[joint].parent;
        }
        rows[body.up * self.columns + self.columns - 1] = 1.0;
    }

    /// Position Jacobian of a control point, `(3, columns)`.
    ///
    /// A joint with the angular velocity `ω` moves the points below it by `ω × (position − joint)`.
    pub(super) fn position_rows(&self, body: &Body, base: &Base, point: usize, rows: &mut [f64]) {
        rows.fill(0.0);
        let columns = self.columns;
        let place = self.positions[body.points[point]];
        let from =
            |joint: usize| -> [f64; 3] { std::array::from_fn(|c| place[c] - self.positions[joint][c]) };
        let mut put = |column: usize, value: [f64; 3]| {
            for (c, value) in value.into_iter().enumerate() {
                rows[c * columns + column] = value;
            }
        };
        let mut next = body.active[body.points[point]].parent;
        while let Some(joint) = next {
            let lever = from(joint);
            for i in 0..3 {
                let jacobian = self.jacobians[joint];
                put(3 * joint + i, cross([jacobian[0][i], jacobian[1][i], jacobian[2][i]], lever));
            }
            next = body.active[joint].parent;
        }
        let root = columns - ROOT;
        put(root, rotated([1.0, 0.0], base.heading, body.up));
        put(root + 1, rotated([0.0, 1.0], base.heading, body.up));
        let axis: [f64; 3] = std::array::from_fn(|c| if c == body.up { 1.0 } else { 0.0 });
        put(root + 2, axis);
        put(root + 3, cross(axis, from(0)));
    }
}

pub(super) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn cross_matrix(v: [f64; 3]) -> Matrix {
    [[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]]
}

pub(super) fn times(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| {
        std::array::from_fn(|j| a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j])
    })
}

pub(super) fn transposed(a: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| a[j][i]))
}

/// `1 + first·[v] + second·[v]²`, where `[v]` is the cross-product matrix of `v`.
fn series(v: [f64; 3], first: f64, second: f64) -> Matrix {
    let across = cross_matrix(v);
    let twice = times(&across, &across);
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let one = if i == j { 1.0 } else { 0.0 };
            one + first * across[i][j] + second * twice[i][j]
        })
    })
}

/// The rotation matrix of a unit quaternion.
pub(super) fn matrix(q: [f64; 4]) -> Matrix {
    series([q[1], q[2], q[3]], 2.0 * q[0], 2.0)
}

/// Right Jacobian of the rotation group at the rotation vector `v`: `exp(v + dv) ≈ exp(v) exp(J dv)`.
pub(super) fn right_jacobian(v: [f64; 3]) -> Matrix {
    let square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    let angle = square.sqrt();
    let (first, second) = if square < SMALL_SQUARE {
        (0.5 - square / 24.0, 1.0 / 6.0 - square / 120.0)
    } else {
        let (sine, cosine) = Real::sin_cos(angle);
        ((1.0 - cosine) / square, (angle - sine) / (square * angle))
    };
    series(v, -first, second)
}

/// The inverse of [`right_jacobian`]: `1 + [v]/2 + (1/θ² − (1 + cos θ)/(2θ sin θ)) [v]²`, for angles up to 180°.
pub(super) fn right_jacobian_inverse(v: [f64; 3]) -> Matrix {
    let square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    let second = if square < SMALL_SQUARE {
        1.0 / 12.0 + square / 720.0
    } else {
        let half = 0.5 * square.sqrt();
        let (sine, cosine) = Real::sin_cos(half);
        (1.0 - half * cosine / sine) / square
    };
    series(v, 0.5, second)
}
