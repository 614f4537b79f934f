//! Noise that looks like motion: estimates from video jump about as fast as limbs move.
//!
//! Spectra of the angular velocity in Hann windows that overlap by half give, as medians over joints and windows, the excess `E`, the shape,
//! and the whiteness; the acceleration is the median over the joints of a quantile. Then, with ramps from 0 to 1,
//! `u = R(acceleration) R(E) R(shape)`. Clean motion falls as `f^−1.45`, white excess grows as `f²`; they cross at
//! `(123 / (E − .096))^(1/3.45)` Hz, and a doubtful `u` moves the cut-off up by `u^−.29`.

use super::{difference, increments, length, middle, quantile};
use crate::parallel::{self, Interrupt};
use crate::{ClipView, Error, Real};

/// Hertz: of clips with more frames per second so many are looked at.
const RATE: f64 = 30.0;

/// Seconds of a window.
const SECONDS: f64 = 2.1;

/// Radians per second, root mean square: a joint that is slower in a window says nothing about its spectrum.
const FASTEST: f64 = 0.5;

/// Bands of the angular velocity, hertz: low, middle, high and top.
const BANDS: [(f64, f64); 4] = [(0.4, 3.0), (3.0, 5.0), (7.0, 9.0), (11.0, 15.0)];

/// Radians per second, root mean square: slower joints have no acceleration that counts.
const RESTLESS: f64 = 0.2;

const ACCELERATION_QUANTILE: f64 = 0.95;

/// Radians per second squared: recordings of people stay below the first, and above the second it is certainly noise.
const ACCELERATIONS: (f64, f64) = (220.0, 320.0);

/// Power at 7 to 9 Hz over that at 0.4 to 3 Hz: clean motion has about 0.1.
const EXCESSES: (f64, f64) = (0.10, 0.14);

/// Power at 7 to 9 Hz over that at 3 to 5 Hz: what swings quickly and regularly is below.
const SHAPES: (f64, f64) = (0.15, 0.25);

/// Power at 11 to 15 Hz over that at 7 to 9 Hz, from which noise is white.
const WHITE: f64 = 1.4;

/// Hertz: lowest and highest cut-off. Lower ones flatten peaks, and estimate withheld measurements worse than a straight line does.
const CUTOFFS: (f64, f64) = (6.5, 7.5);

/// Estimated nanoseconds per frame that is looked at and joint.
const NANOSECONDS: usize = 600;

/// Excess, shape and whiteness of a joint in a window.
type Ratios = [f64; 3];

/// Measures whether a clip jitters as estimates from video do, and where a filter should cut it off.
///
/// Returns `u`, the cut-off in hertz, acceleration, excess, shape and whiteness; zeros for clips that are too short or too slow to tell.
///
/// # Errors
/// [`Error::Interrupted`].
pub fn tracker_noise<T: Real>(
    q: ClipView<'_, T>,
    fps: f64,
    interrupt: &Interrupt,
) -> Result<[f64; 6], Error> {
    let every = (fps / RATE + 0.5).to_count().max(1);
    let rate = fps / every as f64;
    let length = (SECONDS * rate + 0.5).to_count();
    let window = Window::new(length, rate);
    let steps = q.frames().saturating_sub(1) / every;
    if steps < length || window.bands.iter().any(Vec::is_empty) {
        return Ok([0.0; 6]);
    }
    let joints: Vec<usize> = (0..q.joints()).collect();
    let found = parallel::map(joints, steps * q.joints() * NANOSECONDS, |_, joint| {
        interrupt.check()?;
        let velocity: Vec<[f64; 3]> =
            increments(q, joint, every).into_iter().map(|step| step.map(|x| x * rate)).collect();
        let starts = (0..=velocity.len() - length).step_by((length / 2).max(1));
        let ratios: Vec<Ratios> =
            starts.filter_map(|start| window.ratios(&velocity[start..start + length])).collect();
        Ok((ratios, acceleration(&velocity, rate)))
    })?;
    let mut accelerations: Vec<f64> = found.iter().filter_map(|(_, acceleration)| *acceleration).collect();
    let strength = middle(&mut accelerations);
    let ratios: Vec<Ratios> = found.into_iter().flat_map(|(ratios, _)| ratios).collect();
    if ratios.is_empty() || strength <= 0.0 {
        return Ok([0.0; 6]);
    }
    let [excess, shape, white] = [0, 1, 2].map(|column| {
        let mut values: Vec<f64> = ratios.iter().map(|ratios| ratios[column]).collect();
        middle(&mut values)
    });
    let mut u = ramp(strength, ACCELERATIONS) * ramp(excess, EXCESSES) * ramp(shape, SHAPES);
    if white > WHITE {
        u = 0.0;
    }
    let crossing = (123.0 / f64::max(excess - 0.096, 1e-9)).powf(1.0 / 3.45);
    let mut cutoff = crossing.clamp(CUTOFFS.0, CUTOFFS.1);
    if u > 0.0 {
        cutoff *= u.powf(-0.29);
    }
    Ok([u, cutoff, strength, excess, shape, white])
}

/// A Hann window and its waves.
struct Window {
    hann: Vec<f64>,
    /// For each band its waves: cosine and sine at each frame.
    bands: [Vec<Vec<(f64, f64)>>; 4],
}

impl Window {
    fn new(length: usize, rate: f64) -> Self {
        let turn = 2.0 * std::f64::consts::PI / length as f64;
        let hann = (0..length)
            .map(|t| {
                let (sine, _) = Real::sin_cos(turn / 2.0 * (t as f64 + 0.5));
                sine * sine
            })
            .collect();
        let bands = BANDS.map(|(lowest, highest)| {
            (0..=length / 2)
                .filter(|&bin| {
                    let hertz = bin as f64 / length as f64 * rate;
                    hertz >= lowest && hertz <= highest
                })
                .map(|bin| {
                    (0..length)
                        .map(|t| {
                            // Whole turns do not matter.
                            let (sine, cosine) = Real::sin_cos(turn * (bin * t % length) as f64);
                            (cosine, sine)
                        })
                        .collect()
                })
                .collect()
        });
        Self { hann, bands }
    }

    /// The ratios of a joint in a window; None where it is not there or does not move.
    fn ratios(&self, velocity: &[[f64; 3]]) -> Option<Ratios> {
        let count = velocity.len() as f64;
        let squares: f64 = velocity.iter().map(|&v| length(v) * length(v)).sum();
        let speed = (squares / count).sqrt();
        if !(speed.is_finite() && speed > FASTEST) {
            return None;
        }
        let mean: [f64; 3] = std::array::from_fn(|c| velocity.iter().map(|v| v[c]).sum::<f64>() / count);
        let values: Vec<[f64; 3]> =
            velocity.iter().zip(&self.hann).map(|(&v, hann)| difference(v, mean).map(|x| x * hann)).collect();
        let [low, medium, high, top] = self.bands.each_ref().map(|waves| power(&values, waves));
        Some([high / low, high / medium, top / high])
    }
}

/// Mean power of windowed vectors at the frequencies of waves.
fn power(values: &[[f64; 3]], waves: &[Vec<(f64, f64)>]) -> f64 {
    let total: f64 = waves
        .iter()
        .map(|wave| {
            let (mut even, mut odd) = ([0.0; 3], [0.0; 3]);
            for (value, (cosine, sine)) in values.iter().zip(wave) {
                for c in 0..3 {
                    even[c] += cosine * value[c];
                    odd[c] += sine * value[c];
                }
            }
            length(even) * length(even) + length(odd) * length(odd)
        })
        .sum();
    total / waves.len() as f64
}

/// A quantile of the angular acceleration of a joint that moves, radians per second squared.
fn acceleration(velocity: &[[f64; 3]], rate: f64) -> Option<f64> {
    let there: Vec<[f64; 3]> = velocity.iter().copied().filter(|v| v[0].is_finite()).collect();
    let squares: f64 = there.iter().map(|&v| length(v) * length(v)).sum();
    let mut sizes: Vec<f64> = velocity
        .windows(2)
        .map(|pair| length(difference(pair[1], pair[0])) * rate)
        .filter(|size| size.is_finite())
        .collect();
    let moves = (squares / there.len() as f64).sqrt() > RESTLESS;
    (moves && !sizes.is_empty()).then(|| quantile(&mut sizes, ACCELERATION_QUANTILE))
}

/// 0 below the first, 1 above the second, and a straight line between.
fn ramp(x: f64, (low, high): (f64, f64)) -> f64 {
    ((x - low) / (high - low)).clamp(0.0, 1.0)
}
