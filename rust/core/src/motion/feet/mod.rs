//! Feet on the ground: their targets, and inverse kinematics of the legs.
//!
//! - `paths`: the best estimate of a foot's path;
//! - `contacts`: its ground contacts;
//! - `targets`: its target position during a contact;
//! - `displacements`: its displacements over time;
//! - `chain`, `place`: damped least squares on pelvis, hips and knees.

mod chain;
mod contacts;
mod displacements;
mod paths;
mod place;
mod targets;

pub use displacements::{Displacements, FootPaths, foot_displacements};
pub use place::{Body, Placed, place_feet};

/// A point or a direction.
type Point = [f64; 3];

/// Runs of frames in which a mask is true.
fn runs(mask: &[bool]) -> Vec<std::ops::Range<usize>> {
    let mut runs = Vec::new();
    let mut start = 0;
    for part in mask.chunk_by(|a, b| a == b) {
        let end = start + part.len();
        if part[0] {
            runs.push(start..end);
        }
        start = end;
    }
    runs
}

/// Speed of a path at each frame, per frame: central differences, one-sided at the ends.
fn speeds(path: &[Point]) -> Vec<f64> {
    let last = path.len().saturating_sub(1);
    let speed = |t: usize| {
        let (before, after) = (t.saturating_sub(1), (t + 1).min(last));
        let scale = if after - before == 2 { 0.5 } else { 1.0 };
        let step: Point = std::array::from_fn(|c| (path[after][c] - path[before][c]) * scale);
        norm(step)
    };
    (0..path.len()).map(speed).collect()
}

fn norm(x: Point) -> f64 {
    (x[0] * x[0] + x[1] * x[1] + x[2] * x[2]).sqrt()
}

fn inner(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn add(a: Point, b: Point) -> Point {
    std::array::from_fn(|c| a[c] + b[c])
}

fn subtract(a: Point, b: Point) -> Point {
    std::array::from_fn(|c| a[c] - b[c])
}

fn scaled(a: Point, factor: f64) -> Point {
    a.map(|x| x * factor)
}

fn is_known(x: Point) -> bool {
    x.iter().all(|x| x.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_begin_and_end_where_the_mask_changes() {
        assert_eq!(runs(&[true, false, false, true, true]), vec![0..1, 3..5]);
        assert_eq!(runs(&[false, false]), Vec::<std::ops::Range<usize>>::new());
        assert_eq!(runs(&[]), Vec::<std::ops::Range<usize>>::new());
    }

    #[test]
    fn speeds_of_a_straight_path_are_equal() {
        let path: Vec<Point> = (0..5).map(|t| [f64::from(t) * 3.0, f64::from(t) * 4.0, 1.0]).collect();
        assert_eq!(speeds(&path), vec![5.0; 5]);
        assert_eq!(speeds(&path[..2]), vec![5.0; 2]);
    }
}
