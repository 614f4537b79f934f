//! Ground contact of foot joints: low speed and height, with hysteresis.

use super::paths::low_passed;
use super::{Point, runs, speeds};
use crate::parallel::Interrupt;
use crate::{Error, Real};

/// Seconds and centimetres: for the noise `ν` the path is low-passed with the standard deviation `0.05 ν / (ν + 0.3)`
/// s. Without it noise would count as speed.
const LOW_PASS: f64 = 0.05;
const LOW_PASS_NOISE: f64 = 0.3;

/// Largest noise used in the thresholds, centimetres.
const MOST_NOISE: f64 = 2.5;

/// Speed below which a contact begins: centimetres per second, and per second and centimetre of noise.
const ENTER_SPEED: f64 = 15.0;
const ENTER_SPEED_NOISE: f64 = 5.0;

/// Height below which a contact begins, centimetres; the noise is added.
const ENTER_HEIGHT: f64 = 5.0;

/// Speed and height below which a contact continues.
const STAY_SPEED: f64 = 20.0;
const STAY_SPEED_NOISE: f64 = 6.0;
const STAY_HEIGHT: f64 = 6.0;

/// Fraction of the heights below the ground level, so that a single low frame does not define it.
const GROUND: f64 = 0.005;

/// Shortest contact, in seconds and in frames. Noise causes short contacts by chance: the seconds apply in proportion
/// to the noise, fully from `CHANCE` centimetres on.
const SHORTEST: f64 = 0.1;
const CHANCE: f64 = 0.3;
pub(super) const FEWEST: usize = 3;

/// Longest gap, in seconds, across which two contacts are merged.
const LONGEST_GAP: f64 = 0.05;

/// Finds the frames in which a path in centimetres is on the ground; unknown frames are not contacts.
pub(super) fn find(
    y: &[Point],
    known: &[bool],
    noise: f64,
    (up, down): (usize, bool),
    fps: f64,
    interrupt: &Interrupt,
) -> Result<Vec<bool>, Error> {
    let frames = y.len();
    let mut result = vec![false; frames];
    if frames < FEWEST || !known.contains(&true) {
        return Ok(result);
    }
    let path = low_passed(y, LOW_PASS * noise / (noise + LOW_PASS_NOISE) * fps, interrupt)?;
    let extra = f64::min(noise, MOST_NOISE);
    let speed = speeds(&path);
    let height: Vec<f64> = path.iter().map(|point| if down { -point[up] } else { point[up] }).collect();
    let ground = percentile(height.iter().zip(known).filter(|&(_, &known)| known).map(|(&h, _)| h).collect());
    let below = |t: usize, fastest: f64, highest: f64| {
        known[t] && speed[t] * fps < fastest && height[t] - ground < highest
    };
    let enter = |t: usize| below(t, ENTER_SPEED + ENTER_SPEED_NOISE * extra, ENTER_HEIGHT + extra);
    let stay: Vec<bool> =
        (0..frames).map(|t| below(t, STAY_SPEED + STAY_SPEED_NOISE * extra, STAY_HEIGHT + extra)).collect();
    for run in runs(&stay) {
        if run.clone().any(enter) {
            result[run].fill(true);
        }
    }
    let gaps: Vec<bool> = result.iter().map(|touching| !touching).collect();
    for gap in runs(&gaps) {
        let inside = gap.start > 0 && gap.end < frames;
        if inside && gap.len() as f64 <= LONGEST_GAP * fps && known[gap.clone()].iter().all(|&known| known) {
            result[gap].fill(true);
        }
    }
    let shortest = SHORTEST * fps * f64::min(noise / CHANCE, 1.0);
    for run in runs(&result.clone()) {
        if run.len() < FEWEST || (run.len() as f64) < shortest {
            result[run].fill(false);
        }
    }
    Ok(result)
}

/// The quantile [`GROUND`] of the heights, interpolated; there is at least one height, and none is NaN.
fn percentile(mut heights: Vec<f64>) -> f64 {
    let place = GROUND * (heights.len() - 1) as f64;
    let below = place.to_count().min(heights.len() - 1);
    let (_, &mut low, above) = heights.select_nth_unstable_by(below, f64::total_cmp);
    let next = above.iter().copied().fold(f64::INFINITY, f64::min);
    let part = place - below as f64;
    if part > 0.0 { low + (next - low) * part } else { low }
}
