//! The algebra of unit quaternions, on one quaternion and on arrays of them.
//!
//! Unit quaternions are a double cover of the rotations: `q` and `−q` are the same rotation. A rotation by the angle
//! θ about the unit axis u is `q = (cos θ/2, sin θ/2 · u)`. The logarithm `log q = θ/2 · u` is a vector of the
//! tangent space at the identity, half the rotation vector, and `exp` is its inverse. The algebra uses quaternions as
//! given; functions of rotations (distance, means, filters) do not depend on their signs.
//!
//! A sample is *missing* if a component is not finite or all four are zero.

mod one;
mod rows;
mod scan;

pub use one::{
    angle_between, between, conjugate_one, dot, exp_one, geodesic, is_missing, log_one, log_short, lower,
    negative, of_row, product, rotate, unit,
};
pub use rows::{conjugate, exp, geodesic_distance, log, multiply, normalize};
pub use scan::{Scan, scan};

pub(super) use rows::{map_rows, rows};
