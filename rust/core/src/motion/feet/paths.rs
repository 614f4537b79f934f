//! Paths of foot joints: the best estimate from a path and its filtered version.

use super::{Point, is_known};
use crate::Error;
use crate::clip::Planes;
use crate::filters::columns::{BLOCK, Mask};
use crate::filters::smooth::PathSmoother;
use crate::noise::noise::noise_level_of_positions;
use crate::parallel::Interrupt;
use crate::window::Boundary;

/// Standard deviation in frames below which a mask is one frame wide.
const SHORTEST_SIGMA: f64 = 0.05;

/// Interpolates the unknown frames of a path linearly; the ends are constant.
pub(super) fn complete(path: &mut [Point]) {
    let known: Vec<usize> = (0..path.len()).filter(|&t| is_known(path[t])).collect();
    let (Some(&first), Some(&last)) = (known.first(), known.last()) else { return };
    let (start, end) = (path[first], path[last]);
    path[..first].fill(start);
    path[last + 1..].fill(end);
    for pair in known.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        let (from, to) = (path[a], path[b]);
        for (i, point) in path[a + 1..b].iter_mut().enumerate() {
            let slope: Point = std::array::from_fn(|c| (to[c] - from[c]) / (b - a) as f64);
            *point = std::array::from_fn(|c| slope[c] * (i + 1) as f64 + from[c]);
        }
    }
}

/// Estimates a path from the input's path `x` and its filtered version `f`, both without unknown frames; returns the
/// noise `ν` of `x`.
///
/// `y = f + g (smooth(x) − f)` with `g = 1 − ν²/r²`, at least 0, and `r²` the mean square of `x − f` per coordinate.
/// If a filter removes more than the noise, it has removed motion.
pub(super) fn estimate(
    x: &[Point],
    f: &[Point],
    smoother: &PathSmoother,
    interrupt: &Interrupt,
) -> Result<(Vec<Point>, f64), Error> {
    let flat = x.as_flattened();
    let mut noise = [0.0];
    noise_level_of_positions(flat, 1, &mut noise)?;
    let noise = noise[0];
    let squares: f64 = flat.iter().zip(f.as_flattened()).map(|(x, f)| (x - f) * (x - f)).sum();
    let change = squares / flat.len() as f64;
    let share = if change > 0.0 { (1.0 - noise * noise / change).max(0.0) } else { 0.0 };
    let mut y = f.to_vec();
    if share > 0.0 {
        let mut smoothed = vec![0.0; flat.len()];
        smoother.smooth(flat, noise, &mut smoothed, interrupt)?;
        for (y, smoothed) in y.as_flattened_mut().iter_mut().zip(&smoothed) {
            *y += share * (smoothed - *y);
        }
    }
    Ok((y, noise))
}

/// Low-passes a path with a Gaussian mask of the standard deviation `sigma` in frames; its ends are repeated.
pub(super) fn low_passed(path: &[Point], sigma: f64, interrupt: &Interrupt) -> Result<Vec<Point>, Error> {
    let frames = path.len();
    if sigma < SHORTEST_SIGMA || frames < 2 {
        return Ok(path.to_vec());
    }
    let mut planes = Planes::new(3, frames.next_multiple_of(BLOCK));
    let mut columns = planes.rows_mut::<3>(0);
    for (c, column) in columns.iter_mut().enumerate() {
        for (value, point) in column.iter_mut().zip(path) {
            *value = point[c];
        }
    }
    let mut scratch = Planes::default();
    Mask::gaussian(sigma).means(&mut columns, None, (frames, Boundary::Nearest), &mut scratch, interrupt)?;
    Ok((0..frames).map(|t| std::array::from_fn(|c| columns[c][t])).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknown_frames_lie_on_a_line_between_their_neighbours() {
        let gone = [f64::NAN; 3];
        let mut path = [gone, [1.0, 0.0, 0.0], gone, gone, [4.0, 6.0, 0.0], gone];
        complete(&mut path);
        assert_eq!(path[0], [1.0, 0.0, 0.0]);
        assert_eq!(path[2], [2.0, 2.0, 0.0]);
        assert_eq!(path[5], [4.0, 6.0, 0.0]);
        let mut nothing = [gone];
        complete(&mut nothing);
        assert!(nothing[0][0].is_nan());
    }
}
