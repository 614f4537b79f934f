//! Frames of principal geodesic coordinates: the centre of a joint's motion, and its axes in order of importance.
//!
//! There are two frames per joint.
//!
//! The first consists of the principal geodesics of the squared sine. The centre and the first geodesic minimise the
//! mean `sin² d`: the main eigenvector of `Σ q qᵀ` and the great circle through the first two. The second axis does
//! so for the residuals: an eigenvector of `Σ u uᵀ` over the samples `(w, u)`. The third axis is orthogonal to both.
//! They exist whether or not there is a unique mean.
//!
//! The second frame is for joints of two degrees of freedom, for any range of angles. If `q = c exp(s₁ v₁) exp(s₂
//! v₂)`, the vectors `l = R(c) v₁` and `v₂` satisfy `l · R(q) v₂ = 0` in every frame. So `l` and `v₂` are the vectors
//! that minimise the mean square of this product.

use crate::geodesics::eigen::vectors;
use crate::parallel::{self, Interrupt};
use crate::rotations::quaternion::{between, is_missing, product, rotate, unit};
use crate::{ClipView, Error, Real};

/// Approximate number of evenly spaced frames from which axes are computed.
const SAMPLES: usize = 1024;

/// Number of alternating improvements of the two vectors of the second frame.
const ROUNDS: usize = 40;

const IDENTITY: [f64; 4] = [1.0, 0.0, 0.0, 0.0];

type Vector = [f64; 3];

/// Two frames for each joint, each a centre and the rotation that takes x, y and z to the axes.
///
/// A joint without valid samples has unit quaternions.
///
/// # Errors
/// [`Error::Interrupted`].
pub fn principal_frames<T: Real>(
    clip: ClipView<'_, T>,
    interrupt: &Interrupt,
) -> Result<Vec<[[[f64; 4]; 2]; 2]>, Error> {
    let joints = clip.joints();
    let stride = clip.frames().div_ceil(SAMPLES).max(1);
    let some: Vec<f64> = (0..clip.frames())
        .step_by(stride)
        .flat_map(|frame| clip.slice(frame, frame + 1).data())
        .map(|x| x.to_f64())
        .collect();
    let frames = some.len() / (4 * joints).max(1);
    let (samples, _) = some.as_chunks::<4>();
    parallel::map((0..joints).collect(), joints * (frames * 150 + 60_000), |_, joint: usize| {
        interrupt.check()?;
        let path: Vec<[f64; 4]> = samples
            .iter()
            .skip(joint)
            .step_by(joints)
            .filter(|&&q| !is_missing(q))
            .map(|&q| unit(q))
            .collect();
        if path.is_empty() {
            return Ok([[IDENTITY; 2]; 2]);
        }
        let mut moments = [[0.0; 4]; 4];
        for &q in &path {
            add_outer(&mut moments, q);
        }
        let [_, _, beside, centre] = vectors(moments);
        Ok([geodesics(&path, centre, beside), surface(&path, centre)])
    })
}

/// The geodesic through two orthogonal points, 90° apart on S³, and the next geodesic for its residuals.
fn geodesics(path: &[[f64; 4]], centre: [f64; 4], beside: [f64; 4]) -> [[f64; 4]; 2] {
    let [_, x, y, z] = between(centre, beside);
    let first = [x, y, z];
    let mut moments = [[0.0; 3]; 3];
    for q in path.iter().map(|&q| between(centre, q)) {
        // Projection: the normalised (w, v·u) is (cos s, sin s).
        let along = dot3(first, [q[1], q[2], q[3]]);
        let radius = (q[0] * q[0] + along * along + f64::TINY_SQUARE).sqrt();
        let (cosine, sine) = (q[0] / radius, along / radius);
        let left = product([cosine, -sine * first[0], -sine * first[1], -sine * first[2]], q);
        add_outer(&mut moments, [left[1], left[2], left[3]]);
    }
    // An eigenvalue far below all others makes the second axis orthogonal to the first, even for zero residuals.
    let depth = 4.0 * path.len() as f64;
    for i in 0..3 {
        for j in 0..3 {
            moments[i][j] -= depth * first[i] * first[j];
        }
    }
    let second = vectors(moments)[2];
    [centre, rotation_to(first, second)]
}

fn surface(path: &[[f64; 4]], centre: [f64; 4]) -> [[f64; 4]; 2] {
    let mut moments = [[0.0; 9]; 9];
    for &q in path {
        let matrix = matrix(q);
        let flat: [f64; 9] = std::array::from_fn(|i| matrix[i / 3][i % 3]);
        add_outer(&mut moments, flat);
    }
    let least = vectors(moments)[0];
    let mut outer_moments = [[0.0; 3]; 3];
    for column in 0..3 {
        add_outer(&mut outer_moments, [least[column], least[3 + column], least[6 + column]]);
    }
    let mut outer = vectors(outer_moments)[2];
    let mut inner = [0.0; 3];
    for _ in 0..ROUNDS {
        let seen_from_outside = std::array::from_fn(|j| {
            std::array::from_fn(|l| pairs(|i, k| outer[i] * moments[3 * i + j][3 * k + l] * outer[k]))
        });
        inner = vectors(seen_from_outside)[0];
        let seen_from_inside = std::array::from_fn(|i| {
            std::array::from_fn(|k| pairs(|j, l| inner[j] * moments[3 * i + j][3 * k + l] * inner[l]))
        });
        outer = vectors(seen_from_inside)[0];
    }
    let [w, x, y, z] = centre;
    let first = rotate([w, -x, -y, -z], outer);
    let along = dot3(inner, first);
    let first: Vector = std::array::from_fn(|i| first[i] - inner[i] * along);
    let length = dot3(first, first).sqrt();
    if length < 0.5 {
        // The vectors are inconsistent: there is no such surface.
        return [centre, IDENTITY];
    }
    let first = first.map(|x| x / length);
    let there = rotate(centre, first);
    let axis = cross(there, outer);
    let rotation = unit([1.0 + dot3(there, outer), axis[0], axis[1], axis[2]]);
    [product(rotation, centre), rotation_to(first, inner)]
}

/// The sum of `f` over all pairs of indices.
fn pairs(f: impl Fn(usize, usize) -> f64) -> f64 {
    (0..9).map(|i| f(i / 3, i % 3)).sum()
}

fn dot3(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Adds `v vᵀ`.
fn add_outer<const N: usize>(sums: &mut [[f64; N]; N], v: [f64; N]) {
    for (row, a) in sums.iter_mut().zip(v) {
        for (sum, b) in row.iter_mut().zip(v) {
            *sum += a * b;
        }
    }
}

/// Rotation matrix.
fn matrix(q: [f64; 4]) -> [Vector; 3] {
    let [w, x, y, z] = q;
    [
        [w * w + x * x - y * y - z * z, 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), w * w - x * x + y * y - z * z, 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), w * w - x * x - y * y + z * z],
    ]
}

/// The rotation that takes x and y to two orthonormal vectors, with `w ≥ 0`.
fn rotation_to(a: Vector, b: Vector) -> [f64; 4] {
    let c = cross(a, b);
    // Four times the products of the components; the row with the largest square is accurate.
    let rows = [
        [1.0 + a[0] + b[1] + c[2], b[2] - c[1], c[0] - a[2], a[1] - b[0]],
        [b[2] - c[1], 1.0 + a[0] - b[1] - c[2], b[0] + a[1], c[0] + a[2]],
        [c[0] - a[2], b[0] + a[1], 1.0 - a[0] + b[1] - c[2], c[1] + b[2]],
        [a[1] - b[0], c[0] + a[2], c[1] + b[2], 1.0 - a[0] - b[1] + c[2]],
    ];
    let largest = (1..4).fold(0, |best, i| if rows[i][i] > rows[best][best] { i } else { best });
    let q = unit(rows[largest]);
    q.map(|x| if q[0] < 0.0 { -x } else { x })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geodesics::compress::chart::{Frame, coordinates};

    #[test]
    fn two_degrees_of_freedom_are_found() {
        let (a, b) = (unit([0.0, 1.0, 2.0, -1.0]), unit([0.0, 1.0, 0.0, 1.0]));
        let rotate = |axis: [f64; 4], s: f64| {
            let (sine, cosine) = Real::sin_cos(s);
            [cosine, sine * axis[1], sine * axis[2], sine * axis[3]]
        };
        let path: Vec<[f64; 4]> = (0..400)
            .map(|i| {
                let t = f64::from(i) * 0.05;
                product(
                    rotate(a, 0.3 + 0.4 * Real::sin_cos(t).0),
                    rotate(b, 0.2 * Real::sin_cos(1.7 * t).1 - 0.5),
                )
            })
            .collect();
        let flat = path.as_flattened();
        let clip = ClipView::new(flat, path.len(), 1).expect("the length fits");
        let frames = principal_frames(clip, &Interrupt::new()).expect("nobody interrupts");
        let [centre, axes] = frames[0][1];
        let s = coordinates(&path, Frame { centre, axes });
        assert!(s[2].iter().all(|s| s.abs() < 1e-9));
        let [centre, axes] = frames[0][0];
        let s = coordinates(&path, Frame { centre, axes });
        assert!(s[2].iter().any(|s| s.abs() > 1e-3));
    }
}
