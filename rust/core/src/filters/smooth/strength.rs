//! How much to smooth: read off the spectra of blocks of a column, by Stein's unbiased risk estimate.
//!
//! A candidate is an order `o` of differences and a cut-off `f`, a square of frequency; of a sine of the frequency `ω` it leaves
//! `h = 1 / (1 + (μ/f)ᵒ)`, `μ = 2 − 2 cos ω`. With the cosine transform `c` of a block of unit noise
//!
//! ```text
//! risk              = Σ_k (1 − h_k)² c_k² + 2 Σ_k h_k
//! −2 log likelihood = Σ_k (1 − h_k) c_k² − Σ_k log(1 − h_k)
//! ```
//!
//! and candidates are weighted by `exp(−risk / 8 + 0.4 log likelihood)`.

use super::spectrum::{BATCH, Transform};
use crate::Real;
use crate::simd::multiversion;
use std::f64::consts::PI;

/// Frames of a block, at most: long enough for the slowest cut-off, short enough for what a body does to change.
const BLOCK: usize = 512;

/// Orders of the differences that may be penalised are 1 up to this.
const ORDERS: usize = super::penalised::HIGHEST;

/// How many cut-offs are tried for each order.
const CUTOFFS: usize = 18;

/// The largest cut-off: with it hardly anything is smoothed.
const SOFTEST: f64 = 64.0;

/// The least softness `fᵒ`: below it the equations of the smoother lose their digits.
const STIFFEST: f64 = 1e-10;

/// Frequencies that have a bin of their own; after them each bin is wider than the one before.
const FINE_BINS: usize = 8;

/// What differences of the risk are divided by.
const TEMPERATURE: f64 = 8.0;

/// Share of the logarithm of the likelihood beside the risk.
const LIKELIHOOD: f64 = 0.4;

/// By how much all blocks together have a say in each of them.
const SHARED: f64 = 0.5;

/// Numbers of one block, one for each candidate.
type Scores = [f64; ORDERS * CUTOFFS];

/// What is to be known of columns of one length.
#[derive(Debug, Clone)]
pub(super) struct Candidates {
    frames: usize,
    block: usize,
    transform: Transform,
    starts: Vec<usize>,
    /// Logarithms of the cut-offs.
    logs: [[f64; CUTOFFS]; ORDERS],
    /// First frequency of each bin, and the number of all.
    edges: Vec<usize>,
    /// Of each candidate: what the power of each bin adds to its score.
    factors: Vec<f64>,
    /// Of each candidate: the part of the score that is always there.
    offsets: Scores,
}

/// Memory of a chooser.
#[derive(Debug)]
pub(super) struct Memory {
    transform: Transform,
    powers: Vec<[f64; BATCH]>,
    bins: Vec<[f64; BATCH]>,
    /// Of each block.
    scores: Vec<Scores>,
}

impl Candidates {
    /// For columns of at least two frames.
    pub(super) fn new(frames: usize) -> Self {
        let block = BLOCK.min(1 << frames.ilog2());
        let mut starts: Vec<usize> = (0..=frames - block).step_by((block / 2).max(1)).collect();
        if !(frames - block).is_multiple_of((block / 2).max(1)) {
            starts.push(frames - block);
        }
        let mut mu: Vec<f64> = (0..block)
            .map(|k| {
                let (_, cos) = Real::sin_cos(PI * k as f64 / block as f64);
                2.0 - 2.0 * cos
            })
            .collect();
        // The mean of a block moves too: it counts as a quarter of the lowest frequency.
        mu[0] = mu[1] / 4.0;
        let edges = edges(block);
        let bins = edges.len() - 1;
        let mut logs = [[0.0; CUTOFFS]; ORDERS];
        let mut factors = Vec::with_capacity(ORDERS * CUTOFFS * bins);
        let mut offsets = [0.0; ORDERS * CUTOFFS];
        for order in 0..ORDERS {
            let power = order + 1;
            let lowest = mu[0].ln().max(STIFFEST.ln() / power as f64);
            let highest = SOFTEST.ln();
            for c in 0..CUTOFFS {
                let log = lowest + (highest - lowest) * c as f64 / (CUTOFFS - 1) as f64;
                logs[order][c] = log;
                let cutoff = Real::exp(log);
                let removed: Vec<f64> = mu
                    .iter()
                    .map(|mu| {
                        let ratio = (mu / cutoff).powi(i32::try_from(power).unwrap_or(1));
                        ratio / (1.0 + ratio)
                    })
                    .collect();
                for edge in edges.windows(2) {
                    let part = &removed[edge[0]..edge[1]];
                    let term = |r: &f64| r * r / TEMPERATURE + r * (LIKELIHOOD / 2.0);
                    factors.push(part.iter().map(term).sum::<f64>() / part.len() as f64);
                }
                let freedom: f64 = removed.iter().map(|r| 1.0 - r).sum();
                let logs: f64 = removed.iter().map(|r| r.ln()).sum();
                offsets[order * CUTOFFS + c] = freedom * (2.0 / TEMPERATURE) - logs * (LIKELIHOOD / 2.0);
            }
        }
        let transform = Transform::new(block);
        Self { frames, block, transform, starts, logs, edges, factors, offsets }
    }

    /// How many frames the columns have.
    pub(super) fn frames(&self) -> usize {
        self.frames
    }

    /// Memory for [`Candidates::choose`].
    pub(super) fn memory(&self) -> Memory {
        Memory {
            transform: self.transform.clone(),
            powers: vec![[0.0; BATCH]; self.block],
            bins: vec![[0.0; BATCH]; self.edges.len() - 1],
            scores: Vec::with_capacity(self.starts.len()),
        }
    }

    /// Chooses the order for a column of unit noise, and writes the softness of each difference; returns the order, from 1.
    pub(super) fn choose(&self, z: &[f64], softness: &mut [f64], memory: &mut Memory) -> usize {
        let Memory { transform, powers, bins, scores: found } = memory;
        found.clear();
        for starts in self.starts.chunks(BATCH) {
            transform.powers(z, starts, powers);
            for (bin, edge) in bins.iter_mut().zip(self.edges.windows(2)) {
                *bin = [0.0; BATCH];
                for power in &powers[edge[0]..edge[1]] {
                    for i in 0..BATCH {
                        bin[i] += power[i];
                    }
                }
            }
            let mut batch = [[0.0; BATCH]; ORDERS * CUTOFFS];
            score(&self.factors, &self.offsets, bins, &mut batch);
            found.extend((0..starts.len()).map(|lane| batch.map(|scores| scores[lane])));
        }
        let blocks = found.len() as f64;
        let mut mean = [0.0; ORDERS * CUTOFFS];
        for scores in found.iter() {
            for (mean, score) in mean.iter_mut().zip(scores) {
                *mean += score / blocks;
            }
        }
        let share = self.frames as f64 / self.block as f64;
        let whole = mean.map(|score| score * share);
        let least = whole.iter().fold(f64::INFINITY, |least, &score| least.min(score));
        let weight = |order: usize| {
            let own = &whole[order * CUTOFFS..(order + 1) * CUTOFFS];
            own.iter().map(|score| Real::exp(least - score)).sum::<f64>()
        };
        let weights: [f64; ORDERS] = std::array::from_fn(weight);
        let best =
            (1..ORDERS).fold(0, |best, order| if weights[order] > weights[best] { order } else { best });
        let own = best * CUTOFFS..(best + 1) * CUTOFFS;
        let logs = &self.logs[best];
        let settled: Vec<f64> = if self.starts.len() == 1 {
            vec![weighted(logs, &whole[own])]
        } else {
            let settle = |scores: &Scores| {
                let mixed: [f64; CUTOFFS] =
                    std::array::from_fn(|c| scores[own.start + c] + SHARED * mean[own.start + c]);
                weighted(logs, &mixed)
            };
            found.iter().map(settle).collect()
        };
        let order = best + 1;
        self.interpolate(&settled, order, softness);
        order
    }

    /// Writes `fᵒ` of each difference; between the centres of blocks the logarithm of `f` is interpolated.
    fn interpolate(&self, settled: &[f64], order: usize, softness: &mut [f64]) {
        let power = order as f64;
        let middle = order / 2;
        // Two frames have no third difference.
        let rows = self.frames.saturating_sub(order);
        let centre = |block: usize| self.starts[block] as f64 + (self.block - 1) as f64 / 2.0;
        // From one centre to the next, and before the first and beyond the last, it is a straight line.
        let last = settled.len() - 1;
        let mut row = 0;
        for next in 0..=settled.len() {
            let end = match self.starts.get(next) {
                Some(start) if next <= last => {
                    (start + self.block.div_ceil(2)).saturating_sub(middle).min(rows)
                }
                _ => rows,
            };
            let before = next.saturating_sub(1);
            let slope = if next == 0 || next > last {
                0.0
            } else {
                (settled[next] - settled[before]) / (centre(next) - centre(before))
            };
            for (t, softness) in softness.iter_mut().enumerate().take(end).skip(row) {
                *softness = settled[before] + slope * ((t + middle) as f64 - centre(before));
            }
            row = row.max(end);
        }
        exponentials(&mut softness[..rows], power);
    }
}

/// Borders of the bins of frequencies.
fn edges(block: usize) -> Vec<usize> {
    let mut edges: Vec<usize> = (0..=FINE_BINS.min(block)).collect();
    let mut last = FINE_BINS.min(block);
    while last < block {
        last = (last + 1).max(last + last / 8).min(block);
        edges.push(last);
    }
    edges
}

/// Mean of values weighted by `exp(−score)`.
fn weighted(values: &[f64; CUTOFFS], scores: &[f64]) -> f64 {
    let least = scores.iter().fold(f64::INFINITY, |least, &score| least.min(score));
    let (mut sum, mut total) = (0.0, 0.0);
    for (value, score) in values.iter().zip(scores) {
        let weight = Real::exp(least - score);
        sum += weight * value;
        total += weight;
    }
    sum / total
}

multiversion! {
    /// What speaks against each candidate in each block of a batch.
    fn score<T: Real>(
        factors: &[T], offsets: &[T; ORDERS * CUTOFFS], bins: &[[T; BATCH]],
        scores: &mut [[T; BATCH]; ORDERS * CUTOFFS],
    ) {
        for ((scores, offset), factors) in scores.iter_mut().zip(offsets).zip(factors.chunks_exact(bins.len())) {
            let mut sum = [*offset; BATCH];
            for (factor, bin) in factors.iter().zip(bins) {
                for i in 0..BATCH {
                    sum[i] += *factor * bin[i];
                }
            }
            *scores = sum;
        }
    }
}

multiversion! {
    /// `exp(power·x)`, in place.
    fn exponentials<T: Real>(values: &mut [T], power: T) {
        for value in values {
            *value = (power * *value).exp();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chosen(z: &[f64]) -> (usize, Vec<f64>) {
        let candidates = Candidates::new(z.len());
        let mut softness = vec![f64::NAN; z.len()];
        let order = candidates.choose(z, &mut softness, &mut candidates.memory());
        softness.truncate(z.len().saturating_sub(order));
        (order, softness)
    }

    #[test]
    fn the_shortest_columns_have_a_strength_too() {
        for frames in 2..20 {
            for size in [0.0, 1e-3, 1.0, 1e6] {
                let z: Vec<f64> = (0..frames).map(|t| size * f64::from(t * 5 % 7)).collect();
                let (order, softness) = chosen(&z);
                assert!((1..=ORDERS).contains(&order));
                assert!(softness.iter().all(|&s| s >= 0.99 * STIFFEST && s.is_finite()), "{frames} {size}");
            }
        }
    }

    #[test]
    fn what_stands_far_out_of_the_noise_is_hardly_smoothed_and_nothing_at_all_is_smoothed_most() {
        let wave: Vec<f64> = (0..700).map(|t| 1e4 * f64::from(t * 211 % 97)).collect();
        let (order, softness) = chosen(&wave);
        let softest = SOFTEST.powi(i32::try_from(order).unwrap_or(0));
        assert!(softness.iter().all(|&s| s > 0.9 * softest));
        let (_, softness) = chosen(&vec![0.0; 700]);
        assert!(softness.iter().all(|&s| s < 1e-3));
    }

    #[test]
    fn where_a_clip_grows_lively_it_is_smoothed_less() {
        let noise = |t: i32| f64::from(t * 7919 % 201) / 60.0 - 5.0 / 3.0;
        let wave = |t: i32| if t < 2048 { 0.0 } else { 2.0 * Real::sin_cos(f64::from(t) / 5.0).0 };
        let z: Vec<f64> = (0..4096).map(|t| noise(t) + wave(t)).collect();
        let (_, softness) = chosen(&z);
        assert!(softness[100] < 0.5 * softness[4000], "{} {}", softness[100], softness[4000]);
    }
}
