//! Coloured noise: how strongly the noise of one frame depends on that of the frame before.

use super::motion::median;
use super::noise::{GROUP, increments};
use crate::clip::Planes;
use crate::{ClipView, Error, Real, parallel};
use std::f64::consts::PI;

/// Increments under a Hann window, at most; the next window begins half of it later.
const WINDOW: usize = 128;

/// Frames: shorter clips show too few frequencies.
const SHORTEST: usize = 64;

/// Least and largest frequency that is looked at, as a share of half the frame rate.
const BAND: (f64, f64) = (0.06, 0.98);

/// How many values of `ρ` are tried, and the distance between them, from 0.
const CANDIDATES: usize = 20;
const CANDIDATE_STEP: f64 = 0.05;

/// Shares of motion that are tried for each column, besides none: from the least one to the largest.
const MOTIONS: usize = 16;
const LEAST_MOTION: f64 = 1e-3;
const MOST_MOTION: f64 = 1e2;

/// Radians²: columns with a spectrum below it hold rounding, not noise.
const LEAST_POWER: f64 = 1e-10;

/// `ρ` below it is chance: white noise.
const LEAST_COLOUR: f64 = 0.12;

/// Estimates `ρ` of noise that follows `n_{t+1} = ρ n_t + e_t`, the same for all joints: 0 for white noise.
///
/// The spectrum of each coordinate is that of noise and of motion that is accelerated at random,
/// `l (1 / (1 + ρ² − 2ρ cos ω) + a (2 − 2 cos ω)⁻²)`; Whittle's likelihood, with the best `l` and `a` for each column, decides on `ρ`.
///
/// # Errors
/// None; the type is that of parallel work.
pub fn noise_colour<T: Real>(q: ClipView<'_, T>) -> Result<f64, Error> {
    if q.frames() < SHORTEST {
        return Ok(0.0);
    }
    let fit = Fit::new(q.frames() - 1);
    let groups = (0..q.joints()).step_by(GROUP).collect();
    let totals = parallel::map(groups, q.data().len() * 2000, |_, first: usize| {
        let joints = GROUP.min(q.joints() - first);
        let mut planes = Planes::new(joints * 3, q.frames() - 1);
        increments(q, first, joints, &mut planes);
        let mut total = [0.0; CANDIDATES];
        for column in 0..joints * 3 {
            if let Some(spectrum) = fit.spectrum(planes.row(column)) {
                fit.add_misfits(&spectrum, &mut total);
            }
        }
        Ok(total)
    })?;
    let mut total = [0.0; CANDIDATES];
    for part in totals {
        for (sum, x) in total.iter_mut().zip(part) {
            *sum += x;
        }
    }
    let best = (1..CANDIDATES).fold(0, |best, i| if total[i] < total[best] { i } else { best });
    let colour = CANDIDATE_STEP * (best as f64 + vertex(&total, best));
    Ok(if colour >= LEAST_COLOUR { colour } else { 0.0 })
}

/// Windows, frequencies and models for columns of one length.
struct Fit {
    /// Hann's window.
    mask: Vec<f64>,
    /// Cosines and sines of each frequency under the window, a row for each.
    waves: Vec<(Vec<f64>, Vec<f64>)>,
    /// `2 − 2 cos ω`.
    roughness: Vec<f64>,
    /// For each candidate and each share of motion `1 / f`, and `Σ ln f`.
    models: Vec<Vec<(Vec<f64>, f64)>>,
}

impl Fit {
    fn new(steps: usize) -> Self {
        let length = WINDOW.min(steps);
        let mask: Vec<f64> = (1..=length)
            .map(|i| {
                let (sine, _) = Real::sin_cos(PI * i as f64 / (length + 1) as f64);
                sine * sine
            })
            .collect();
        let frequency = |k: usize| 2.0 * PI * k as f64 / length as f64;
        let seen: Vec<usize> = (0..=length / 2)
            .filter(|&k| frequency(k) >= BAND.0 * PI && frequency(k) <= BAND.1 * PI)
            .collect();
        let cosine = |x: f64| Real::sin_cos(x).1;
        let waves = seen
            .iter()
            .map(|&k| {
                // The angle of a whole number of periods less: small angles keep their digits.
                let angles = (0..length).map(|t| frequency(k * t % length));
                angles
                    .map(|angle| {
                        let (s, c): (f64, f64) = Real::sin_cos(angle);
                        (c, s)
                    })
                    .unzip()
            })
            .collect();
        let roughness: Vec<f64> = seen.iter().map(|&k| 2.0 - 2.0 * cosine(frequency(k))).collect();
        let growth = (MOST_MOTION / LEAST_MOTION).ln() / (MOTIONS - 1) as f64;
        let shares: Vec<f64> = std::iter::once(0.0)
            .chain((0..MOTIONS).map(|i| LEAST_MOTION * Real::exp(growth * i as f64)))
            .collect();
        let models = (0..CANDIDATES)
            .map(|candidate| {
                let rho = CANDIDATE_STEP * candidate as f64;
                shares
                    .iter()
                    .map(|share| {
                        let model = roughness.iter().map(|r| {
                            // 1 + ρ² − 2ρ cos ω
                            let noise = 1.0 / ((1.0 - rho) * (1.0 - rho) + rho * r);
                            noise + share / (r * r)
                        });
                        let model: Vec<f64> = model.collect();
                        let logs = model.iter().map(|f| f.ln()).sum();
                        (model.iter().map(|f| 1.0 / f).collect(), logs)
                    })
                    .collect()
            })
            .collect();
        Self { mask, waves, roughness, models }
    }

    /// The spectrum of the motion from half its increments; nothing for a column without a window, or of rounding.
    fn spectrum<T: Real>(&self, column: &[T]) -> Option<Vec<f64>> {
        let length = self.mask.len();
        let mut powers: Vec<Vec<f64>> = vec![Vec::new(); self.waves.len()];
        let mut window = vec![0.0; length];
        for start in (0..=column.len() - length).step_by(length / 2) {
            let values = &column[start..start + length];
            if values.iter().any(|x| !x.is_finite()) {
                continue;
            }
            for ((to, x), mask) in window.iter_mut().zip(values).zip(&self.mask) {
                *to = 2.0 * x.to_f64() * mask;
            }
            for (powers, (cosines, sines)) in powers.iter_mut().zip(&self.waves) {
                let (mut real, mut imaginary) = (0.0, 0.0);
                for ((x, c), s) in window.iter().zip(cosines).zip(sines) {
                    real += x * c;
                    imaginary += x * s;
                }
                powers.push(real * real + imaginary * imaginary);
            }
        }
        let squares: f64 = self.mask.iter().map(|x| x * x).sum();
        let spectrum: Option<Vec<f64>> = powers
            .iter_mut()
            .zip(&self.roughness)
            .map(|(powers, r)| median(powers).map(|power| power / r / squares))
            .collect();
        spectrum.filter(|spectrum| spectrum.iter().all(|&x| x >= LEAST_POWER))
    }

    /// Adds the least negative log likelihood of a spectrum over the shares of motion for each candidate, but for a constant.
    fn add_misfits(&self, spectrum: &[f64], total: &mut [f64; CANDIDATES]) {
        let count = spectrum.len() as f64;
        for (total, models) in total.iter_mut().zip(&self.models) {
            let misfits = models.iter().map(|(inverse, logs)| {
                let level = spectrum.iter().zip(inverse).map(|(s, i)| s * i).sum::<f64>() / count;
                logs + count * level.ln()
            });
            *total += misfits.fold(f64::INFINITY, f64::min);
        }
    }
}

/// Where the parabola through a minimum and its neighbours has its vertex, in steps from it; 0 at an end.
fn vertex(values: &[f64; CANDIDATES], best: usize) -> f64 {
    if best == 0 || best + 1 == CANDIDATES {
        return 0.0;
    }
    let (before, here, after) = (values[best - 1], values[best], values[best + 1]);
    let bend = before - 2.0 * here + after;
    if bend > 0.0 { (before - after) / (2.0 * bend) } else { 0.0 }
}
